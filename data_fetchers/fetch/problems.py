# SPDX-License-Identifier: GPL-3.0-or-later
"""What can go wrong, by who can mend it. Each carries one sentence for the user."""
from urllib.parse import urlsplit, urlunsplit


class UserError(Exception):
    """Usage, input, permissions, a full disk: exit code 2."""
    code = 2


class ServerError(Exception):
    """A remote server failed: exit code 3."""
    code = 3


def public(url):
    """An address without what may be secret: user, password and query."""
    parts = urlsplit(url)
    host = parts.hostname or ""
    if parts.port:
        host += f":{parts.port}"
    return urlunsplit((parts.scheme, host, parts.path, "", ""))
