"""Locks that a forked child finds free and what they guard whole, whatever other threads do.

A fork waits for the call that holds a lock, a step at most. Without that, the child would have a
lock that no thread of it ever gives back.
"""

from __future__ import annotations

import os
import threading
import weakref
from typing import Any, ContextManager

# Reentrant, because the handler of a signal may fork wherever its thread is.
_registry = threading.RLock()
_locks: weakref.WeakSet[Any] = weakref.WeakSet()
_held: list[list[Any]] = []


def new_lock() -> ContextManager[Any]:
    """A lock that no other thread holds while a process is forked."""
    lock = threading.RLock()
    with _registry:
        _locks.add(lock)
    return lock


def _take() -> None:
    # A lock that is made from now on waits for the end of the fork.
    _registry.acquire()
    locks = list(_locks)
    for lock in locks:
        lock.acquire()
    _held.append(locks)


def _give_back() -> None:
    for lock in _held.pop():
        lock.release()
    _registry.release()


os.register_at_fork(before=_take, after_in_parent=_give_back, after_in_child=_give_back)
