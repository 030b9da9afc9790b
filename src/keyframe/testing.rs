//! A synthetic texture for the tests of this module.

/// Side of the texture \[px\].
pub const SIDE: usize = 200;

/// Soft spots in pseudo-random places, the same in every call, rotated clockwise by `roll` \[rad\]
/// and enlarged by `scale` about the centre, plus uniform noise of `noise` grey levels.
pub fn texture(roll: f32, scale: f32, noise: u32) -> [u8; SIDE * SIDE] {
    let mut state = 12_345u32;
    let mut below = |n: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) % n.max(1)
    };
    // x, y and radius [px], brightness [grey levels].
    let spots: [[f32; 4]; 400] = core::array::from_fn(|_| {
        let mut one = |n| below(n) as f32;
        [
            one(300) - 150.0,
            one(300) - 150.0,
            one(4) + 3.0,
            one(160) - 80.0,
        ]
    });
    let (cos, sin) = (libm::cosf(roll) / scale, libm::sinf(roll) / scale);
    let middle = (SIDE / 2) as f32;
    core::array::from_fn(|i| {
        let (x, y) = ((i % SIDE) as f32 - middle, (i / SIDE) as f32 - middle);
        let (x, y) = (x * cos + y * sin, y * cos - x * sin);
        let light: f32 = spots
            .iter()
            .map(|[sx, sy, radius, light]| {
                let (dx, dy) = (x - sx, y - sy);
                let far = (dx * dx + dy * dy) / (radius * radius);
                if far < 4.0 {
                    light * (1.0 - far / 4.0)
                } else {
                    0.0
                }
            })
            .sum();
        let noisy = light as i32 + 128 + below(noise + 1) as i32 - noise as i32 / 2;
        noisy.clamp(0, 255) as u8
    })
}
