"""Models: their bytes, and what they say of themselves."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Union

import numpy as np
import numpy.typing as npt

from . import _layout as layout
from ._library import FOLDER, PosewiseError, aligned, call, lib, sized

#: The optional parts that the library was built with.
PARTS: tuple[str, ...] = tuple(
    name for name, bit in layout.PARTS.items() if lib.posewise_parts() & bit
)


@dataclass(frozen=True)
class ModelInfo:
    """What a model says of itself, and what is wrong with it."""

    #: As "posewise.posewise"; empty where it has none.
    name: str
    #: What the terms of its training data allow: "unknown", "free" or "research".
    terms: layout.Terms
    #: Its data sheet, in Markdown.
    sheet: str
    #: Version of the model format.
    format_version: int
    #: Length [bytes].
    length: int
    #: CRC-32 by which models are told apart.
    checksum: int
    #: Names of its sections.
    sections: tuple[str, ...]
    #: The section that is missing or wrong; empty where it is another fault, or none.
    wrong_section: str
    #: Which check it failed; empty for a model that the library can track with.
    check: str


def model_info(model: Union[str, Path] = "posewise") -> ModelInfo:
    """What a model says of itself, also one that the library refuses."""
    return _info(_read(path_of(model)))


def path_of(model: Union[str, Path]) -> Path:
    """The file of a model, which may be given by its name."""
    known = model in ("posewise", "research")
    return FOLDER / f"{model}.posewise" if known else Path(model).resolve()


@lru_cache(maxsize=None)
def checked(path: Path) -> npt.NDArray[np.uint8]:
    """A model, which all trackers share."""
    model = _read(path)
    status = lib.posewise_model_check(model.ctypes.data, len(model))
    if status != 0:
        info = _info(model)
        section = f"{info.wrong_section}: " if info.wrong_section else ""
        raise PosewiseError(status, section + info.check)
    return model


def _read(path: Path) -> npt.NDArray[np.uint8]:
    file = np.fromfile(path, dtype=np.uint8)
    model = aligned(len(file))
    model[:] = file
    return model


def _info(model: npt.NDArray[np.uint8]) -> ModelInfo:
    out = sized(layout.ModelDetails())
    call("model_info", model.ctypes.data, len(model), ctypes.byref(out))
    return ModelInfo(
        name=_text(out.name, out.name_len),
        terms=layout.TERMS[out.terms],
        sheet=_text(out.sheet, out.sheet_len),
        format_version=out.format_version,
        length=out.length,
        checksum=out.checksum,
        sections=tuple(_tag(number) for number in out.sections[: out.section_count]),
        wrong_section=_tag(out.wrong_section) if out.wrong_section else "",
        check=_text(out.check, out.check_len),
    )


def _text(at: int, length: int) -> str:
    return ctypes.string_at(at, length).decode() if length else ""


def _tag(number: int) -> str:
    """The four characters of a section's name."""
    return number.to_bytes(4, "little").decode("ascii", "replace")
