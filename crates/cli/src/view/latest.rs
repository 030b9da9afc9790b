//! The newest message, for viewers of any speed: none is kept for anybody who is not waiting.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use tungstenite::Bytes;

/// Hands messages from one producer to the viewers that wait at that moment.
#[derive(Default)]
pub struct Latest {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    waiting: usize,
    number: u64,
    message: Bytes,
    /// Why there will be no more.
    ended: Option<&'static str>,
}

impl Latest {
    /// Whether somebody waits.
    pub fn is_wanted(&self) -> bool {
        self.lock().waiting > 0
    }

    /// Gives a message to all that wait.
    pub fn put(&self, message: Bytes) {
        let mut state = self.lock();
        state.number += 1;
        state.message = message;
        self.changed.notify_all();
    }

    /// Waits for the next message; at the end gives the reason.
    pub fn next(&self) -> Result<Bytes, &'static str> {
        let mut state = self.lock();
        let seen = state.number;
        state.waiting += 1;
        let waits = |state: &mut State| state.number == seen && state.ended.is_none();
        let mut state =
            (self.changed.wait_while(state, waits)).unwrap_or_else(PoisonError::into_inner);
        state.waiting -= 1;
        match state.ended {
            Some(reason) => Err(reason),
            None => Ok(state.message.clone()),
        }
    }

    /// Tells all that wait, now or later, that this is the end.
    pub fn end(&self, reason: &'static str) {
        self.lock().ended = Some(reason);
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
