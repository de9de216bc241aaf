"""A bundle to an archive service with Zenodo's interface: all of it published, or nothing."""

from __future__ import annotations

import contextlib
import hashlib
from pathlib import Path
from typing import Any

import requests

TIMEOUT_S = (10.0, 600.0)
"""To connect, and between two packets."""


class UploadError(RuntimeError):
    """The bundle was not published; the message says why and what is left."""


def upload(
    path: Path, metadata: dict[str, Any], *, api: str, token: str, publish: bool = False
) -> str:
    """Make a draft, send the bundle and its metadata, and publish it if that is asked for.

    The draft is published only if the service received the very bytes; after any failure before
    that it is deleted.

    Args:
        path: the bundle.
        metadata: what Zenodo needs.
        api: address of the interface, for instance https://zenodo.org/api.
        token: access token of the depositor.
        publish: publish the draft; else it is left for the depositor to look at.

    Returns:
        Address of the record or of the draft.

    Raises:
        UploadError: the service refused or the connection was cut.
    """
    with requests.Session() as session:
        session.headers["Authorization"] = f"Bearer {token}"
        draft = _answer(session, "POST", f"{api}/deposit/depositions", json={})
        address = str(draft["links"]["self"])
        try:
            _send(session, path, f"{draft['links']['bucket']}/{path.name}")
            _answer(session, "PUT", address, json={"metadata": metadata})
        except (UploadError, OSError) as error:
            left = _withdraw(session, address)
            raise UploadError(f"{error}; nothing is published{left}") from error
        if not publish:
            return str(draft["links"].get("html", address))
        try:
            record = _answer(session, "POST", str(draft["links"]["publish"]))
        except UploadError as error:
            raise UploadError(
                f"{error}; whether the draft {address} was published is not known: look at it "
                "before trying again"
            ) from error
        return str(record["links"].get("record_html", address))


def _send(session: requests.Session, path: Path, address: str) -> None:
    with path.open("rb") as file:
        told = _answer(session, "PUT", address, data=file).get("checksum")
    with path.open("rb") as file:
        expected = hashlib.file_digest(file, "md5").hexdigest()  # the sum that the service tells
    if told != f"md5:{expected}":
        raise UploadError("the service received other bytes than were sent")


def _answer(session: requests.Session, method: str, address: str, **content: Any) -> dict[str, Any]:
    try:
        answer = session.request(method, address, timeout=TIMEOUT_S, **content)
        answer.raise_for_status()
        told = answer.json()
    except requests.RequestException as error:
        raise UploadError(f"{method} {address}: {error}") from error
    if not isinstance(told, dict):
        raise UploadError(f"{method} {address}: the answer is no deposit")
    return told


def _withdraw(session: requests.Session, address: str) -> str:
    """Delete a draft; what is left where that fails too."""
    with contextlib.suppress(requests.RequestException):
        if session.delete(address, timeout=TIMEOUT_S).ok:
            return " and the draft is deleted"
    return f"; an unpublished draft is left at {address}"
