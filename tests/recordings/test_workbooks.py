"""Excel workbooks: a sheet says the same as the CSV of its cells, and broken ones are refused."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import openpyxl
import pytest

from spacerobot.recordings.draft import draft_study
from spacerobot.recordings.readers import read_table
from spacerobot.recordings.study import load_study
from spacerobot.recordings.table import Options
from spacerobot.support.errors import InputError

ROWS = [[k / 50, 0.03 * k / 50 - 0.3, None if k == 4 else 0.5 * k] for k in range(60)]
HEAD = ["t", "x_target_m", "F [N]"]


def workbook(path: Path, *, before: int = 0, sheets: tuple[str, ...] = ("log",)) -> None:
    book = openpyxl.Workbook()
    book.remove(book.active)
    for n, name in enumerate(sheets):
        sheet = book.create_sheet(name)
        for k in range(before):
            sheet.append([f"remark {k}"])
        sheet.append(HEAD)
        for row in ROWS:
            sheet.append([row[0], row[1] + n, row[2]])
    book.save(path)


@pytest.mark.parametrize("before", [0, 2])
def test_a_sheet_reads_like_its_csv(tmp_path: Path, before: int) -> None:
    workbook(tmp_path / "log.xlsx", before=before)
    lines = [",".join(HEAD), *(",".join("" if v is None else repr(v) for v in row) for row in ROWS)]
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    sheet, plain = read_table(tmp_path / "log.xlsx"), read_table(tmp_path / "log.csv")
    assert sheet.names() == plain.names() == tuple(HEAD)
    for name in HEAD:
        np.testing.assert_allclose(sheet[name], plain[name], rtol=1e-15)  # workbooks keep 16 digits


def test_the_stated_sheet_is_read_else_the_first_with_a_remark(tmp_path: Path) -> None:
    path = tmp_path / "log.xlsx"
    workbook(path, sheets=("first", "second"))
    assert read_table(path, Options(variable="second"))["x_target_m"][0] == pytest.approx(0.7)
    assert "first" in read_table(path).notes[0]
    with pytest.raises(InputError, match="first, second"):
        read_table(path, Options(variable="third"))


def test_a_folder_of_workbooks_becomes_a_study(tmp_path: Path) -> None:
    workbook(tmp_path / "run1_9kg.xlsx")
    workbook(tmp_path / "run2_9kg.xlsx")
    (tmp_path / "study.toml").write_text(draft_study(tmp_path))
    study = load_study(tmp_path)
    assert [t.id for t in study.trials] == ["run1", "run2"]
    assert study.value("target.mass", "run1") == 9.0
    assert not study.recording("run1")["contact.force"].valid.all()


@pytest.mark.parametrize("kind", ["text", "empty zip", "bomb", "no sheet"])
def test_what_is_no_workbook_is_refused(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "log.xlsx"
    if kind == "text":
        path.write_bytes(b"PK no zip at all")
    else:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            if kind == "bomb":
                archive.writestr("[Content_Types].xml", b"<a>" + b" " * 50_000_000)
            elif kind == "no sheet":
                archive.writestr("xl/workbook.xml", "<workbook/>")
    with pytest.raises(InputError, match=r"log\.xlsx"):
        read_table(path)
