//! Pose-wise SVM templates on hand-made descriptors (thesis 4.4): linear SVMs per landmark and view
//! on three descriptors ([`descriptor`]), calibrated after Platt and multiplied into one response
//! map per landmark ([`svm`]), by which landmarks are moved ([`correct`]).

pub mod correct;
pub mod descriptor;
pub mod svm;
