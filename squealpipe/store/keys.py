"""Checks that the files of a run are whole, present, and made from this configuration and code."""

from collections.abc import Mapping
from pathlib import Path

from squealpipe.store.rerun.key import key_behind
from squealpipe.store.sealed import attributes
from squealpipe.store.whole_files import StoreError


def stated_key(path: str | Path) -> str | None:
    """The key that a dataset, figure or page states; None if it states none, or was changed."""
    if Path(path).suffix == ".nc":
        key = attributes(path).get("key")
        return None if key is None else str(key)
    return key_behind(path)


def misfits(keys: Mapping[str, str], root: Path = Path()) -> list[str]:
    """Return the files that are missing, damaged or not of this configuration and code, with the
    reason.

    Args:
        keys: file → the key that it must state.
    """
    unfit = []
    for path, key in keys.items():
        try:
            stated = stated_key(root / path)
        except FileNotFoundError:
            unfit.append(f"{path}: missing")
        except StoreError as error:
            unfit.append(f"{path}: {error}")
        else:
            if stated is None:
                unfit.append(
                    f"{path}: changed, or does not state what it was made from"
                )
            elif stated.partition(" ")[2] != key.partition(" ")[2]:
                unfit.append(f"{path}: is a copy of {stated.partition(' ')[2]}")
            elif stated != key:
                unfit.append(f"{path}: made with another configuration or other code")
    return unfit


def refuse_misfits(keys: Mapping[str, str], root: Path = Path()) -> None:
    """Raise if a file is not what it should be."""
    unfit = misfits(keys, root)
    if unfit:
        raise StoreError(
            "not the results of this configuration and code:\n"
            + "\n".join(f"  {line}" for line in unfit)
            + "\ndelete these files and run snakemake, with the same --configfile"
        )
