"""Every test computes on one thread: two test processes with two threads each wait for each other on two cores."""

from move.machine import one_thread, one_thread_in_children

one_thread_in_children()
one_thread()
