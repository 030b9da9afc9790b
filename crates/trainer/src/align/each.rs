//! Many runs of a network in parallel, whose random numbers do not depend on how many threads run.

use posewise::align::Workspace;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// What `run` makes of each item and its number, with random numbers and a workspace.
pub fn each<'i, I: Sync, T: Send>(
    items: &'i [I],
    seed: u64,
    run: impl Fn(usize, &'i I, &mut ChaCha8Rng, &mut Workspace) -> T + Sync,
) -> Vec<T> {
    let numbered = items.par_iter().enumerate();
    let all = numbered.map_init(
        || Box::new(Workspace::new()),
        |work, (index, item)| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(index as u64);
            run(index, item, &mut rng, work)
        },
    );
    all.collect()
}
