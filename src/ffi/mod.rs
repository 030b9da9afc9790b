//! The C ABI (`include/posewise.h`).
