"""HDF5 files: whole ones, and ones that are well-formed and hostile."""

from __future__ import annotations

import random
from pathlib import Path

import h5py
import numpy as np

WORDS = (b"SNOD", b"TREE", b"HEAP", b"OHDR", b"GCOL", b"FRHP", b"BTHD", b"\xff" * 8, b"\x00" * 8, b"deflate\0")


def seed(dice: random.Random, folder: Path, canary: Path) -> bytes:
    """A small file with a few of what HDF5 offers, links to a file that must not be read among it."""
    path = folder / "seed.h5"
    with h5py.File(path, "w", libver=dice.choice(("earliest", "latest", ("v110", "latest")))) as file:
        for index in range(dice.randint(1, 4)):
            dice.choice(_PARTS)(file, f"part{index}", dice, canary)
        if dice.random() < 0.3:
            file.attrs["MATLAB_class"] = dice.choice(("double", b"struct", 3, [1.0, 2.0]))
    data = path.read_bytes()
    path.unlink()
    return data


def _plain(file: h5py.File, name: str, dice: random.Random, canary: Path) -> None:
    kind = dice.choice(("<f8", "<f4", "<i2", ">f8", "u1", "<f2", "S5", "?", "<c16"))
    file[f"{name}/x"] = np.zeros(dice.choice(((3,), (2, 3), (1, 5), (), (2, 2, 2), (0,), (500, 2))), dtype=kind)


def _table(file: h5py.File, name: str, dice: random.Random, canary: Path) -> None:
    inner = np.dtype([("u", "<f8"), ("v", "<i4", (3,))])
    file[name] = np.zeros(dice.randint(0, 5), dtype=[("t", "<f8"), ("x", inner), ("s", "S3")])


def _packed(file: h5py.File, name: str, dice: random.Random, canary: Path) -> None:
    options = dice.choice(({"compression": "gzip"}, {"compression": "lzf"}, {"fletcher32": True}, {"scaleoffset": 3},
                           {"shuffle": True, "compression": "gzip"}))  # fmt: skip
    kind = "<i4" if "scaleoffset" in options else "<f8"
    file.create_dataset(name, data=np.arange(100, dtype=kind), chunks=(10,), maxshape=(None,), **options)


def _claim(file: h5py.File, name: str, dice: random.Random, canary: Path) -> None:
    length = dice.choice((10**5, 10**5, 10**9, 10**9, 2**40, 10**7))
    file.create_dataset(name, (length,), "f8", chunks=(dice.choice((1000, 10**5)),), compression="gzip")


def _links(file: h5py.File, name: str, dice: random.Random, canary: Path) -> None:
    file[f"{name}-out"] = h5py.ExternalLink(str(canary), "/secret")
    file[f"{name}-lost"] = h5py.SoftLink("/nowhere")
    file[f"{name}-self"] = h5py.SoftLink(f"/{name}-self")
    group = file.create_group(name)
    group["loop"] = group
    group["root"] = file["/"]


def _elsewhere(file: h5py.File, name: str, dice: random.Random, canary: Path) -> None:
    if dice.random() < 0.5:
        file.create_dataset(name, (4,), "f8", external=[(str(canary), 0, 32)])
    else:
        layout = h5py.VirtualLayout((4,), "f8")
        layout[:] = h5py.VirtualSource(str(canary), "secret", shape=(4,))
        file.create_virtual_dataset(name, layout)


def _words(file: h5py.File, name: str, dice: random.Random, canary: Path) -> None:
    file[name] = np.array(["a", "bc"], dtype=h5py.string_dtype())
    file[f"{name}-refs"] = np.array([file.ref], dtype=h5py.ref_dtype)
    ragged = file.create_dataset(f"{name}-ragged", (2,), dtype=h5py.vlen_dtype("f8"))
    ragged[0] = np.zeros(3)


def _deep(file: h5py.File, name: str, dice: random.Random, canary: Path) -> None:
    file["/".join([name] * dice.choice((5, 40)))] = 1.0


_PARTS = (_plain, _plain, _plain, _table, _packed, _claim, _links, _elsewhere, _words, _deep)
