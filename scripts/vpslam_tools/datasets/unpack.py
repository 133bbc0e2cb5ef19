"""Takes the files of a sequence out of an archive. Names come from the archive's own, but only as far
as an expression allows, so that nothing lands outside of its folder."""

import re
import shutil
import tarfile
import tempfile
import zipfile
import zlib

from vpslam_tools.errors import UserError


def unpack(archive, part, folder):
    """Files of `archive` that `part` describes, into `folder`; their number."""
    try:
        if part.inner:
            return _unpack_inner(archive, part, folder)
        with open(archive, "rb") as file:
            return _unpack_file(file, part.pattern, folder)
    except (tarfile.TarError, zipfile.BadZipFile, EOFError, zlib.error) as error:
        raise UserError(f"{archive}: cannot be unpacked ({error}); remove it and start again"
                        ) from None


def _unpack_inner(archive, part, folder):
    with zipfile.ZipFile(archive) as outer:
        name = next((each for each in outer.namelist() if re.fullmatch(part.inner, each)), None)
        if name is None:
            raise UserError(f"{archive}: holds no {part.inner}")
        # Deflated archives within archives cannot be read at any place: a copy on disk can.
        with tempfile.TemporaryFile(dir=archive.parent) as copy:
            with outer.open(name) as file:
                shutil.copyfileobj(file, copy, 1 << 20)
            copy.seek(0)
            return _unpack_file(copy, part.pattern, folder)


def _unpack_file(file, pattern, folder):
    if zipfile.is_zipfile(file):
        with zipfile.ZipFile(file) as archive:
            return _write_all(((info.filename, lambda info=info: archive.open(info))
                               for info in archive.infolist() if not info.is_dir()), pattern, folder)
    file.seek(0)
    with tarfile.open(fileobj=file, mode="r:*") as archive:
        return _write_all(((info.name, lambda info=info: archive.extractfile(info))
                           for info in archive if info.isfile()), pattern, folder)


def _write_all(members, pattern, folder):
    count = 0
    for name, open_member in members:
        match = re.fullmatch(pattern, name.removeprefix("./"))
        if not match:
            continue
        path = folder / match.group("path")
        if not path.resolve().is_relative_to(folder.resolve()):
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        with open_member() as source, open(path, "wb") as target:
            shutil.copyfileobj(source, target, 1 << 20)
        count += 1
    return count
