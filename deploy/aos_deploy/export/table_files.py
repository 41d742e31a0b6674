"""Tables as files: CSV, or Parquet. The only import of pyarrow."""

import csv
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from aos_deploy.export.tables import TABLES, Row
from aos_protocol.errors import DeployError

_BATCH_ROWS = 10_000


def write_csv(rows: Iterable[Row], folder: Path) -> dict[str, int]:
    """Writes `<table>.csv` for each table into a folder; the numbers of their rows."""
    counts = dict.fromkeys(TABLES, 0)
    with ExitStack() as files:
        writers = {}
        for table, columns in TABLES.items():
            file = files.enter_context((folder / f"{table}.csv").open("w", newline="", encoding="utf-8"))
            writers[table] = csv.DictWriter(file, columns)
            writers[table].writeheader()
        for row in rows:
            writers[row.table].writerow(row.cells)
            counts[row.table] += 1
    return counts


def write_parquet(rows: Iterable[Row], folder: Path) -> dict[str, int]:
    """Writes `<table>.parquet` for each table into a folder; the numbers of their rows.

    DeployError AOS805 where pyarrow is not installed.
    """
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError as error:
        hint = "Install it: pip install 'aos-autonomy[parquet]', or take --format csv"
        raise DeployError(
            "Parquet needs pyarrow, which is not installed", code="AOS805", hint=hint
        ) from error
    types = {str: pa.string(), int: pa.int64(), float: pa.float64(), bool: pa.bool_()}
    counts = dict.fromkeys(TABLES, 0)
    with ExitStack() as files:
        writers, schemas = {}, {}
        for table, columns in TABLES.items():
            schemas[table] = pa.schema([(name, types[kind]) for name, kind in columns.items()])
            writers[table] = files.enter_context(
                pq.ParquetWriter(folder / f"{table}.parquet", schemas[table])
            )
        for table, cells in _batches(rows):
            whole = [{name: row.get(name) for name in TABLES[table]} for row in cells]
            writers[table].write_table(pa.Table.from_pylist(whole, schema=schemas[table]))
            counts[table] += len(cells)
    return counts


def _batches(rows: Iterable[Row]) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """The rows of each table together, so many at once."""
    kept: dict[str, list[dict[str, Any]]] = {table: [] for table in TABLES}
    for row in rows:
        kept[row.table].append(row.cells)
        if len(kept[row.table]) == _BATCH_ROWS:
            yield row.table, kept[row.table]
            kept[row.table] = []
    for table, cells in kept.items():
        if cells:
            yield table, cells
