"""Logs: one type, readers and writers for CSV, NPZ, MAT, HDF5 and Parquet, channel mapping."""

from rotatum.logs.beside import beside
from rotatum.logs.clock import Clock, Gap
from rotatum.logs.log import Log
from rotatum.logs.reader import LogReader
from rotatum.logs.reading import open_log, read_log
from rotatum.logs.writer import TableWriter, write_table

__all__ = [
    "Clock",
    "Gap",
    "Log",
    "LogReader",
    "TableWriter",
    "beside",
    "open_log",
    "read_log",
    "write_table",
]
