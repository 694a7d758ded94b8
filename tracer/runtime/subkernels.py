"""How functions that only kernels call are compiled: as far as a kernel needs to take them in, and no further.

By default, numba optimises such a function by itself, then again inside each function that calls it, and makes machine
code of it every time.  Only the last of this ever runs.  Here, a subkernel is typed and lowered, and the kernel at the
top optimises all of it at once.
"""

from __future__ import annotations

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler


class _Linked(JITCodeLibrary):
    """Code that is there to be linked into other code: never optimised or run by itself."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """There is no machine code to point to."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self) -> Any:
        """Asked only for `set_env`."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """The kernel that it is linked into has an environment."""


class SubkernelCompiler(Compiler):
    """numba's pipeline, whose result is linked into kernels."""

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        super().__init__(typing, target, library or _Linked(target.codegen(), "subkernel"), *rest)
