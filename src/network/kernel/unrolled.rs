//! Loops that the front end unrolls.

/// Repeats a block for each `$i` below `$count`, which is at most 8. The compiler unrolls loops too
/// late for the arrays of sums to stay in registers.
macro_rules! unrolled {
    ($i:ident < $count:expr => $body:block) => {
        $crate::network::kernel::unrolled!($i < $count => $body, 0 1 2 3 4 5 6 7)
    };
    ($i:ident < $count:expr => $body:block, $($number:literal)*) => {
        $({
            let $i = $number;
            if $i < $count $body
        })*
    };
}
pub(in crate::network) use unrolled;
