"""Results as tables of pandas and data sets of xarray, where these are installed."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from spacerobot.support.errors import InputError

if TYPE_CHECKING:
    import pandas
    import xarray


def data_frame(
    columns: Mapping[str, Any], *, index: Any = None, name: str | None = None, units: Mapping[str, str] | None = None
) -> pandas.DataFrame:
    """A table of pandas.

    Args:
        columns: name -> values, all of one length.
        index: labels of the rows, numbered if None.
        name: of the index.
        units: column -> unit, kept as `frame.attrs["units"]`.

    Raises:
        InputError: pandas is not installed.
    """
    pd = _library("pandas")
    frame = pd.DataFrame(dict(columns), index=None if index is None else pd.Index(np.asarray(index), name=name))
    if units:
        frame.attrs["units"] = dict(units)
    return frame


def joined(frames: Sequence[pandas.DataFrame]) -> pandas.DataFrame:
    """Tables side by side over all their index values, NaN where one has none."""
    pd = _library("pandas")
    whole = pd.concat(list(frames), axis=1, sort=True)
    whole.attrs["units"] = {k: v for f in frames for k, v in f.attrs.get("units", {}).items()}
    return whole


def data_set(
    variables: Mapping[str, tuple[str | tuple[str, ...], Any, str]],
    coordinates: Mapping[str, tuple[str | tuple[str, ...], Any, str]],
    **about: Any,
) -> xarray.Dataset:
    """A data set of xarray.

    Args:
        variables: name -> (dimensions, values, unit).
        coordinates: alike.
        about: of the whole, as its attributes.

    Raises:
        InputError: xarray is not installed.
    """
    xr = _library("xarray")

    def made(found: Mapping[str, tuple[str | tuple[str, ...], Any, str]]) -> dict[str, Any]:
        return {name: (dims, np.asarray(values), {"units": unit}) for name, (dims, values, unit) in found.items()}

    return xr.Dataset(made(variables), made(coordinates), attrs=about)


def _library(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(f"{name} is not installed", valid='pip install "spacerobot[tables]"') from None
