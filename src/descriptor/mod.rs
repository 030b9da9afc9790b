//! Local features of a crop around the landmarks.
