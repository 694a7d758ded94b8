"""Embree by its C interface: one mesh of triangles, and batches of rays by single calls or by packets.

embreex binds single rays alone, but its wheel brings the whole library.  The calls are made from
compiled loops, so that no Python stands between one packet and the next.  Structures are those of
Embree 4.3 and later (rtcore_ray.h, rtcore_scene.h): a packet of N rays is rows of N floats or ints.
"""

from __future__ import annotations

import ctypes
from functools import cache
from importlib.metadata import files, version
from pathlib import Path
from typing import Any, NamedTuple
from weakref import finalize

import numpy as np
from numba import njit
from numpy.typing import NDArray

from tracer.geometry.rays import MISS, Hits, Rays
from tracer.runtime.parallel import for_each_chunk

WIDTHS = (1, 4, 8, 16)
CHUNK = 8192  # rays a thread takes at a time, where there are several

# Rows of a packet: origin and direction take three each; a ray alone has the first RAY_ROWS.
T_NEAR, DIRECTION, T_FAR, MASK, RAY_ROWS = 3, 4, 8, 9, 12
PRIMITIVE, GEOMETRY, HIT_ROWS = 17, 18, 9
NOTHING = np.uint32(0xFFFFFFFF)  # RTC_INVALID_GEOMETRY_ID; as a mask: every geometry

TRIANGLES, INDEX_BUFFER, VERTEX_BUFFER, UINT3, FLOAT3 = 0, 0, 1, 0x5003, 0x9003
BUILD_QUALITY_HIGH, FLAG_ROBUST, FLAG_COHERENT, ALL_FEATURES = 2, 1 << 2, 1 << 16, 0xFFFFFFFF


class Mode(NamedTuple):
    """How rays are put to Embree: how many a call, whether they are said to be coherent, and whether
    packets are filled before the clock starts or, from the batch's arrays and back, while it runs."""

    width: int
    coherent: bool
    prepared: bool

    def __str__(self) -> str:
        rays = "single" if self.width == 1 else f"by {self.width}"
        return f"{rays}{', coherent' if self.coherent else ''}{'' if self.prepared else ', filled on the way'}"


MODES = tuple(Mode(w, c, p) for w in WIDTHS for c in (False, True) for p in (True, False) if w > 1 or not c)


class _Arguments(ctypes.Structure):
    """RTCIntersectArguments, and RTCOccludedArguments alike."""

    _fields_ = (
        ("flags", ctypes.c_uint),
        ("features", ctypes.c_uint),
        ("context", ctypes.c_void_p),
        ("filter", ctypes.c_void_p),
        ("callback", ctypes.c_void_p),
    )


@cache
def library() -> Any:
    """libembree4 of the installed embreex; raises FileNotFoundError where its wheel holds none."""
    found = [file.locate() for file in files("embreex") or () if file.name.startswith("libembree4")]
    if not found:
        raise FileNotFoundError(f"embreex {version('embreex')} brings no libembree4 along")
    loaded = ctypes.CDLL(str(Path(str(found[0]))))
    pointer, whole = ctypes.c_void_p, ctypes.c_uint
    signatures: dict[str, tuple[Any, list[Any]]] = {
        "rtcNewDevice": (pointer, [ctypes.c_char_p]),
        "rtcGetDeviceError": (whole, [pointer]),
        "rtcGetDeviceProperty": (ctypes.c_ssize_t, [pointer, whole]),
        "rtcNewScene": (pointer, [pointer]),
        "rtcSetSceneFlags": (None, [pointer, whole]),
        "rtcSetSceneBuildQuality": (None, [pointer, whole]),
        "rtcNewGeometry": (pointer, [pointer, whole]),
        "rtcSetGeometryBuildQuality": (None, [pointer, whole]),
        "rtcSetNewGeometryBuffer": (pointer, [pointer, whole, whole, whole, ctypes.c_size_t, ctypes.c_size_t]),
        "rtcCommitGeometry": (None, [pointer]),
        "rtcAttachGeometry": (whole, [pointer, pointer]),
        "rtcReleaseGeometry": (None, [pointer]),
        "rtcCommitScene": (None, [pointer]),
        "rtcReleaseScene": (None, [pointer]),
    }
    for width in WIDTHS:
        for name in (f"rtcIntersect{width}", f"rtcOccluded{width}"):
            signatures[name] = (None, [pointer] * (3 if width == 1 else 4))
    for name, (result, arguments) in signatures.items():
        function = getattr(loaded, name)
        function.restype, function.argtypes = result, arguments
    return loaded


@cache
def _device() -> int:
    # One thread to build with; and every instruction set there is, whatever that costs in clock frequency.
    device = library().rtcNewDevice(b"threads=1,frequency_level=simd512")
    if not device:
        raise RuntimeError("Embree makes no device here")
    return int(device)


def embree_version() -> str:
    """As Embree itself gives it, 4.4.0 for instance."""
    number = library().rtcGetDeviceProperty(_device(), 0)
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


class EmbreeScene:
    """Triangles (n, 3, 3) as one mesh under one tree, built at high quality; robust is slower and misses nothing."""

    def __init__(self, triangles: NDArray[np.float32], robust: bool = False) -> None:
        embree = library()
        self.handle = int(embree.rtcNewScene(_device()))
        embree.rtcSetSceneFlags(self.handle, FLAG_ROBUST if robust else 0)
        embree.rtcSetSceneBuildQuality(self.handle, BUILD_QUALITY_HIGH)
        mesh = embree.rtcNewGeometry(_device(), TRIANGLES)
        embree.rtcSetGeometryBuildQuality(mesh, BUILD_QUALITY_HIGH)
        n = len(triangles)
        vertices = np.ascontiguousarray(triangles, np.float32).reshape(-1, 3)
        indices = np.arange(3 * n, dtype=np.uint32).reshape(-1, 3)
        for kind, form, rows in ((VERTEX_BUFFER, FLOAT3, vertices), (INDEX_BUFFER, UINT3, indices)):
            place = embree.rtcSetNewGeometryBuffer(mesh, kind, 0, form, 12, len(rows))
            if not place:
                raise MemoryError("Embree has no room for the triangles")
            ctypes.memmove(place, rows.ctypes.data, rows.nbytes)
        embree.rtcCommitGeometry(mesh)
        embree.rtcAttachGeometry(self.handle, mesh)
        embree.rtcReleaseGeometry(mesh)
        embree.rtcCommitScene(self.handle)
        if error := embree.rtcGetDeviceError(_device()):
            raise RuntimeError(f"Embree cannot build the scene: error {error}")
        finalize(self, embree.rtcReleaseScene, self.handle)


def _aligned(shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Zeros that begin at a multiple of 64 bytes."""
    count = int(np.prod(shape))
    room = np.zeros(count + 16, np.float32)
    start = -room.ctypes.data % 64 // 4
    return room[start : start + count].reshape(shape)


@njit(nogil=True)
def _call_singles(function, scene, arguments, packets, size, first, last):
    for k in range(first, last):
        function(scene, packets + k * size, arguments)


@njit(nogil=True)
def _call_packets(function, scene, arguments, packets, size, first, last, valid, valid_last):
    """Packets first to last of the whole; the batch's last one, which may not be full, has lanes of its own."""
    for k in range(first, last - 1):
        function(valid, scene, packets + k * size, arguments)
    function(valid_last, scene, packets + (last - 1) * size, arguments)


@njit(nogil=True)
def _fill(packet, rays, k):
    """Packet k of a batch; lanes past its end repeat the last ray."""
    width = packet.shape[1]
    for lane in range(width):
        i = min(k * width + lane, len(rays.t_min) - 1)
        for axis in range(3):
            packet[axis, lane] = rays.origin[axis, i]
            packet[DIRECTION + axis, lane] = rays.direction[axis, i]
        packet[T_NEAR, lane], packet[T_FAR, lane] = rays.t_min[i], rays.t_max[i]


@njit(nogil=True)
def _empty(packet, ids, k, hits):
    """What Embree says of packet k: t and, of closest hits, what was hit and where."""
    width = packet.shape[1]
    for lane in range(min(width, len(hits.t) - k * width)):
        i = k * width + lane
        hits.t[i] = packet[T_FAR, lane]
        if len(ids) > RAY_ROWS:
            hits.primitive[i] = ids[PRIMITIVE, lane] if ids[GEOMETRY, lane] != NOTHING else MISS
            hits.u[i], hits.v[i] = packet[PRIMITIVE - 2, lane], packet[PRIMITIVE - 1, lane]


@njit(nogil=True)
def _fill_and_call_singles(function, scene, arguments, packet, ids, rays, hits, first, last):
    for k in range(first, last):
        _fill(packet, rays, k)
        if len(ids) > RAY_ROWS:
            ids[GEOMETRY] = NOTHING
        function(scene, packet.ctypes.data, arguments)
        _empty(packet, ids, k, hits)


@njit(nogil=True)
def _fill_and_call_packets(function, scene, arguments, packet, ids, rays, hits, first, last, valid, valid_last):
    for k in range(first, last):
        _fill(packet, rays, k)
        if len(ids) > RAY_ROWS:
            ids[GEOMETRY] = NOTHING
        function(valid if k < last - 1 else valid_last, scene, packet.ctypes.data, arguments)
        _empty(packet, ids, k, hits)


class EmbreeRays:
    """A batch of rays that Embree is asked about, for closest hits or else for any, in one mode."""

    def __init__(self, scene: EmbreeScene, rays: Rays, closest: bool, mode: Mode, threads: int = 1) -> None:
        self.name, self._scene, self._rays, self._mode, self._threads = str(mode), scene, rays, mode, threads
        width, n = mode.width, len(rays.t_min)
        self._function = getattr(library(), f"rtc{'Intersect' if closest else 'Occluded'}{width}")
        self._arguments = _Arguments(FLAG_COHERENT if mode.coherent else 0, ALL_FEATURES, None, None, None)
        self._packets = -(-n // width)
        rows = RAY_ROWS + (HIT_ROWS if closest else 0)
        self._rows = -(-rows * width // 4) * 4 // width  # a single hit is filled up to 48 bytes
        self._valid = _aligned((2, 16)).view(np.int32)
        self._valid[0], self._valid[1, : n - (self._packets - 1) * width] = -1, -1
        if mode.prepared:
            self._filled, self._work = self._fill_all(), self._buffer(self._packets)
        else:
            self._work = self._buffer(threads)  # one packet for each thread
            self._hits = Hits(*(np.empty(n, np.int32 if i == 1 else np.float32) for i in range(4)))

    def _buffer(self, packets: int) -> NDArray[np.float32]:
        """Packets (packets, rows, width) with nothing hit and no ray yet."""
        # One packet more: without AVX-512, Embree 4.4 reads a hit behind packets of 16 rays that have none.
        made = _aligned((packets + 1, self._rows, self._mode.width))[:packets]
        made.view(np.uint32)[:, MASK] = NOTHING
        if self._rows > RAY_ROWS:
            made.view(np.uint32)[:, PRIMITIVE:] = NOTHING
        return made

    def _fill_all(self) -> NDArray[np.float32]:
        filled, width = self._buffer(self._packets), self._mode.width
        index = np.minimum(np.arange(self._packets * width), len(self._rays.t_min) - 1).reshape(-1, width)
        for axis in range(3):
            filled[:, axis] = self._rays.origin[axis][index]
            filled[:, DIRECTION + axis] = self._rays.direction[axis][index]
        filled[:, T_NEAR], filled[:, T_FAR] = self._rays.t_min[index], self._rays.t_max[index]
        return filled

    def prepare(self) -> None:
        """Fill the packets anew: Embree writes what it finds into them."""
        if self._mode.prepared:
            np.copyto(self._work, self._filled)

    def run(self) -> None:
        """Trace every ray once, by all threads."""
        step = CHUNK // self._mode.width if self._threads > 1 else self._packets
        for_each_chunk(
            lambda chunk, worker: self._trace(chunk * step, step, worker), -(-self._packets // step), self._threads
        )

    def _trace(self, first: int, count: int, worker: int) -> None:
        last = min(first + count, self._packets)
        call = (self._function, self._scene.handle, ctypes.addressof(self._arguments))
        valid: tuple[int, ...] = ()
        if self._mode.width > 1:
            valid = (self._valid[0].ctypes.data, self._valid[int(last == self._packets)].ctypes.data)
        if self._mode.prepared:
            trace = _call_packets if valid else _call_singles
            trace(*call, self._work.ctypes.data, self._work[0].nbytes, first, last, *valid)
        else:
            trace = _fill_and_call_packets if valid else _fill_and_call_singles
            packet = self._work[worker]
            trace(*call, packet, packet.view(np.uint32), self._rays, self._hits, first, last, *valid)

    def answers(self) -> NDArray[np.float32]:
        """(n,) float32 of the last run: t of the closest hits, inf for a miss; or -inf for what is blocked."""
        if not self._mode.prepared:
            return self._hits.t
        return np.ascontiguousarray(self._work[:, T_FAR]).reshape(-1)[: len(self._rays.t_min)]
