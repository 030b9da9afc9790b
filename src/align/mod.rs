//! The cascade of quantised regressors: crop → 68 landmarks.
