"""Downloads a file over HTTP, going on where an earlier attempt stopped.

Beside FILE.part stands FILE.part.json with what the server said of the file then (ETag or date), so
that no two versions are joined (If-Range, RFC 9110 sec. 13.1.5).
"""

import hashlib
import http.client
import json
import os
import time
import urllib.error
import urllib.request

from vpslam_tools.errors import UserError

CHUNK = 1 << 20
ATTEMPTS = 6        # in a row without a byte
WAIT_S = 2.0        # before the second; doubles
TIMEOUT_S = 60
WORTH_WAITING = {408, 425, 429, 500, 502, 503, 504}


def download(url, path, md5, tell):
    """Leaves the file at `path`, unless it is there already."""
    if path.exists():
        return
    part = path.with_name(path.name + ".part")
    path.parent.mkdir(parents=True, exist_ok=True)
    failures = 0
    while True:
        before = _size(part)
        try:
            if _fetch_rest(url, part, tell):
                break
            why = "the connection ended early"
        except urllib.error.HTTPError as error:
            if error.code not in WORTH_WAITING:
                raise UserError(f"{url}: the server says {error.code} {error.reason}; check the "
                                "name, or look at the dataset's page") from None
            why = f"{error.code} {error.reason}"
        except (urllib.error.URLError, http.client.HTTPException, OSError) as error:
            if isinstance(error, OSError) and error.errno == 28:
                raise UserError(f"{part}: no space is left; free some and start again") from None
            why = getattr(error, "reason", error)
        failures = 0 if _size(part) > before else failures + 1
        if failures >= ATTEMPTS:
            raise UserError(f"{url}: {why}; start again later, it goes on where it stopped")
        tell(f"{why}; trying again")
        time.sleep(WAIT_S * 2 ** failures if failures else 0)
    if md5:
        _check(part, path, md5)
    os.replace(part, path)
    _note(part).unlink(missing_ok=True)


def _fetch_rest(url, part, tell):
    """True if the file is complete now."""
    headers = {"User-Agent": "vpslam-fetch-datasets", "Accept-Encoding": "identity"}
    known = _read_note(part)
    if _size(part) and known:
        headers.update({"Range": f"bytes={_size(part)}-", "If-Range": known})
    try:
        response = urllib.request.urlopen(urllib.request.Request(url, headers=headers),
                                          timeout=TIMEOUT_S)
    except urllib.error.HTTPError as error:
        if error.code != 416:  # nothing beyond what is here
            raise
        total = (error.headers.get("Content-Range") or "").rpartition("/")[2]
        if total == str(_size(part)):
            return True
        part.unlink(missing_ok=True)
        return False
    with response, open(part, "ab" if response.status == 206 else "wb") as file:
        done = file.tell()
        _note(part).write_text(json.dumps(
            response.headers.get("ETag") or response.headers.get("Last-Modified")))
        length = response.headers.get("Content-Length")
        total = done + int(length) if length else None
        told = 0.0
        while chunk := response.read(CHUNK):
            file.write(chunk)
            done += len(chunk)
            if time.monotonic() > told + 5:
                tell(f"{done / 1e9:.2f}" + (f" of {total / 1e9:.2f}" if total else "") + " GB")
                told = time.monotonic()
    return total is None or done == total


def _check(part, path, md5):
    digest = hashlib.md5(usedforsecurity=False)
    with open(part, "rb") as file:
        while chunk := file.read(CHUNK):
            digest.update(chunk)
    if digest.hexdigest() != md5:
        part.unlink()
        _note(part).unlink(missing_ok=True)
        raise UserError(f"{path.name}: does not have the published checksum and was removed; start "
                        "again")


def _size(part):
    return part.stat().st_size if part.exists() else 0


def _note(part):
    return part.with_name(part.name + ".json")


def _read_note(part):
    """A weak ETag does not tell whether bytes are the same: then from the beginning."""
    try:
        known = json.loads(_note(part).read_text())
    except (OSError, ValueError):
        return None
    return known if known and not known.startswith("W/") else None
