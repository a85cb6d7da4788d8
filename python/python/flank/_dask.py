"""Chunks of a study on the workers of Dask, which is imported by the call that names a client."""

from __future__ import annotations

import os
import threading
import time
import warnings
from collections.abc import Iterable
from typing import Any

from flank import _flank
from flank._errors import Error, InputError
from flank._points import needed

# A task whose worker has died so often that Dask gives it up is begun again up to so often. The program itself finds the case that kills:
# three attempts at a chunk, then five at each such case. Dask gives up after four.
_BEGUN_AGAIN = 40
# of what a file system refuses for a moment
_RETRIES = 2
# A worker that dies before its nanny has heard that it began is not replaced: this long, in seconds, a new one leaves alone what others may
# have died of.
_SETTLED = 2.0
# so often, in seconds, it is looked whether there are workers at all
_LOOKED = 60.0


def run(client: Any, folder: str, chunks: Iterable[int], again: list[str]) -> None:
    """Has chunks computed, each by a task of its own on one thread. When it is interrupted, no further task begins."""
    distributed = needed("distributed", "on=")
    if not isinstance(client, distributed.Client):
        raise InputError(f"`on` is {client!r}: it is a client of Dask, for example distributed.Client()")
    chunk_of = {_begin(client, folder, chunk, again): chunk for chunk in chunks}
    killed = dict.fromkeys(chunk_of.values(), 0)
    waiting = distributed.as_completed(list(chunk_of))
    ended = threading.Event()
    threading.Thread(target=_watch, args=(client, folder, ended), daemon=True).start()
    try:
        for future in waiting:
            chunk = chunk_of.pop(future)
            if not isinstance(future.exception(), distributed.KilledWorker):
                future.result()
                continue
            killed[chunk] += 1
            if killed[chunk] > _BEGUN_AGAIN:
                raise Error(f"workers die again and again while they begin chunk {chunk} of {folder}; other chunks are kept")
            begun = _begin(client, folder, chunk, again)
            chunk_of[begun] = chunk
            waiting.add(begun)
    finally:
        ended.set()
        client.cancel(list(chunk_of))


def _watch(client: Any, folder: str, ended: threading.Event) -> None:
    """Says that nothing is computed where all workers are gone: Dask waits for others without a word."""
    while not ended.wait(_LOOKED):
        if client.status == "running" and not client.scheduler_info()["workers"]:
            warnings.warn(
                f"no worker of Dask is there: {folder} waits for one, and keeps the chunks that it has where it is interrupted", stacklevel=1
            )


def _begin(client: Any, folder: str, chunk: int, again: list[str]) -> Any:
    return client.submit(_chunk, folder, chunk, again, pure=False, retries=_RETRIES)


# The study that this process works on, by its folder: its job is compiled once, not for each chunk.
_open: dict[str, _flank.OpenStudy] = {}


def _chunk(folder: str, chunk: int, again: list[str]) -> None:
    """The task. Dask gives it one thread."""
    if not _open and os.listdir(os.path.join(folder, "open")):
        time.sleep(_SETTLED)
    study = _open.get(folder)
    if study is None or not study.is_current():
        _open.clear()
        study = _open[folder] = _flank.OpenStudy(folder)
    study.run((chunk, chunk), again, 1)
