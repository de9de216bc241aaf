"""A name to write to that one command at a time may have."""

import os
from contextlib import ExitStack, suppress
from pathlib import Path


def reserve(path: Path, held: ExitStack, option: str) -> None:
    """Keep a name until ``held`` is closed; the lock ends with the process, however that ends.

    Raises:
        ValueError: another command, which still runs, is going to write there; it is part of an
            archive, no regular file, or the folder cannot be written.
    """
    from squealpipe.store.whole_files import StoreError, not_written, refuse_place

    try:
        refuse_place(path)
    except StoreError as error:
        raise ValueError(f"{option} {error}") from error
    try:
        import fcntl
    except ImportError:  # other systems: the later of two commands wins
        return
    lock = path.with_name(f".{path.name[:200]}.writing")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        while True:
            handle = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
            # POSIX allows either where another process holds the lock
            try:
                fcntl.lockf(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except (BlockingIOError, PermissionError) as error:
                os.close(handle)
                raise ValueError(
                    f"{option} {path} is being written by another command; wait for it, or choose "
                    "another name"
                ) from error
            except OSError:  # a file system without locks
                os.close(handle)
                return
            if _is_there(lock, handle):
                break
            os.close(handle)  # its holder ended meanwhile and took the file away
    except OSError as error:
        raise not_written(path, error) from error
    held.callback(os.close, handle)
    held.callback(_remove, lock)


def _is_there(lock: Path, handle: int) -> bool:
    with suppress(FileNotFoundError):
        return os.path.samestat(lock.stat(), os.fstat(handle))
    return False


def _remove(lock: Path) -> None:
    with suppress(OSError):
        lock.unlink()
