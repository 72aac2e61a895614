"""Laws by address: what the integrator calls for the springs, dampers and frictions it does not hold itself."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np

from spacerobot.effects.kernel import compiled
from spacerobot.effects.memory import compiled as compiled_memory


class LawTable:
    """Addresses of every compiled law seen so far, as one array, so that systems hold plain indices."""

    def __init__(self) -> None:
        self._index: dict[Any, int] = {}
        self._kept: list[Any] = []
        self._addresses = np.zeros(1, dtype=np.int64)
        self._lock = threading.Lock()

    def index(self, law: Any, *, memory: bool = False) -> int:
        """The law's place in `laws`, compiling it on first use; `memory` of a law with one."""
        found = self._index.get(law)
        if found is None:
            with self._lock:  # fits run in threads, and the table must not grow twice for one law
                found = self._index.get(law)
                if found is None:
                    self._kept.append(compiled_memory(law) if memory else compiled(law))
                    self._addresses = np.array([k.address for k in self._kept], dtype=np.int64)
                    found = self._index[law] = len(self._kept) - 1
        return found

    @property
    def laws(self) -> np.ndarray:
        """The addresses, shape (at least 1,)."""
        return self._addresses


LAWS = LawTable()
