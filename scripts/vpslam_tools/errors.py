"""What is told to the user as a line, not as a traceback."""

import errno


class UserError(Exception):
    """Something the user can put right; the text names the fault and the remedy."""


def describe(error):
    """One line on an error of a file or the network that no command expected."""
    where = f"{error.filename}: " if error.filename else ""
    remedies = {errno.ENOSPC: "free space there", errno.EDQUOT: "free space there",
                errno.EACCES: "check its permissions", errno.EPERM: "check its permissions",
                errno.EROFS: "name a folder that can be written",
                errno.ENOENT: "check the path", errno.ENOTDIR: "check the path"}
    remedy = remedies.get(error.errno)
    return f"{where}{error.strerror or error}" + (f"; {remedy}" if remedy else "")
