"""Vectors become machine code for processors that are no x86, as on Apple's machines and Arm's servers.

It is made here and looked at, not run: that takes such a machine.
"""

from __future__ import annotations

import functools
import re

import numpy as np
import pytest
from llvmlite import binding

from tests.simd.kinds import F32, I32, compiled
from tracer.simd import (
    fma,
    gather_f32x16,
    largest,
    leading_zeros,
    load_f32x16,
    load_i32x16,
    load_spread_bytes16,
    lowest_bit,
    mask16,
    maximum,
    ones,
    pack,
    power,
    prefetch,
    square_root,
    store,
    store_where,
    to_f32,
)

MACHINES = {
    "aarch64-unknown-linux-gnu": "generic",
    "arm64-apple-macosx13.0": "apple-m1",
    "aarch64-pc-windows-msvc": "generic",
}


@functools.cache
def assembly() -> str:
    """What LLVM is given of a kernel with all that is not plain arithmetic."""

    @compiled
    def run(a, source, places, out, bits):
        x, some = load_f32x16(a), mask16(bits)
        y = fma(x, x, square_root(x))
        store(out, pack(y, some))
        store_where(out + 64, maximum(x, y), some)
        store(out + 128, gather_f32x16(a, load_i32x16(places)))
        store(out + 192, to_f32(load_spread_bytes16(source, some)))
        store(out + 256, power(x, y))
        prefetch(out + 320)
        return largest(x) + ones(bits) + leading_zeros(bits) + lowest_bit(bits)

    a, source, places, out = np.zeros(32, F32), np.zeros(64, np.uint8), np.zeros(16, I32), np.zeros(500, F32)
    run(*(array.ctypes.data for array in (a, source, places, out)), 5)
    return "\n".join(run.inspect_llvm().values())


@pytest.mark.parametrize("machine", MACHINES)
def test_what_vectors_do_can_be_done_without_x86(machine: str):
    binding.initialize_all_targets()
    binding.initialize_all_asmprinters()
    code = assembly()
    assert "llvm.masked" in code and not re.search(r"llvm\.x86|asm sideeffect", code)
    module = binding.parse_assembly(code)
    module.triple = machine
    target = binding.Target.from_triple(machine).create_target_machine(cpu=MACHINES[machine], opt=2)
    module.data_layout = str(target.target_data)
    made = target.emit_assembly(module)
    assert re.search(r"\bfmla[.\t ]", made), "no fused vectors"
    called = set(re.findall(r"^\s+bl\s+\"?([\w.$]+)", made, re.M)) - set(re.findall(r"^\"?([\w.$]+)\"?:", made, re.M))
    unknown = {name for name in called if not re.match(r"_*(mem(cpy|set|move)$|numba_|Py|chkstk)", name)}
    assert not unknown, f"these are in no library there: {unknown}"
