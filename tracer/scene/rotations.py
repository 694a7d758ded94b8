"""Rotations as unit quaternions: arrays (..., 4) of float64, real part first."""

from __future__ import annotations

import numpy as np

from tracer.scene.arrays import Float64


def from_axes(axes: Float64, degrees: Float64) -> Float64:
    """(n, 4) turns about axes (n, 3) of any length by angles (n,); the identity where an axis has none."""
    length = np.linalg.norm(axes, axis=1, keepdims=True)
    half = np.radians(degrees)[:, None] / 2
    turns = np.concatenate([np.cos(half), np.sin(half) * axes / np.where(length > 0, length, 1.0)], axis=1)
    return np.where(length > 0, turns, (1.0, 0.0, 0.0, 0.0))


def matrices(q: Float64) -> Float64:
    """(n, 3, 3) of (n, 4); quaternions need not be quite of unit length."""
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def multiply(p: Float64, q: Float64) -> Float64:
    """First q, then p."""
    pw, px, py, pz = (p[..., i] for i in range(4))
    qw, qx, qy, qz = (q[..., i] for i in range(4))
    return np.stack(
        [
            pw * qw - px * qx - py * qy - pz * qz,
            pw * qx + qw * px + py * qz - pz * qy,
            pw * qy + qw * py + pz * qx - px * qz,
            pw * qz + qw * pz + px * qy - py * qx,
        ],
        axis=-1,
    )


def conjugate(q: Float64) -> Float64:
    """The inverse."""
    return q * np.array([1.0, -1.0, -1.0, -1.0])


def log(q: Float64) -> Float64:
    """(..., 3): axis times half the angle."""
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = np.arctan2(sine, q[..., :1])
    return q[..., 1:] * np.where(sine > 1e-12, angle / np.where(sine > 1e-12, sine, 1.0), 1.0)


def exp(v: Float64) -> Float64:
    """(..., 4): the inverse of `log`."""
    angle = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle), v * np.sinc(angle / np.pi)], axis=-1)


def slerp(p: Float64, q: Float64, u: Float64) -> Float64:
    """From p to q as u (..., 1) goes from 0 to 1; not by the shortest path, for the sign of q is meant."""
    return multiply(p, exp(u * log(multiply(conjugate(p), q))))


def squad(start: Float64, end: Float64, leave: Float64, enter: Float64, u: Float64) -> Float64:
    """Shoemake's cubic from start to end, shaped by two inner quaternions."""
    return slerp(slerp(start, end, u), slerp(leave, enter, u), 2 * u * (1 - u))
