# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue of sources, and what the user's words mean in it."""
import difflib
import os
import tomllib
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from problems import UserError

FILE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "catalogue.toml")


@dataclass
class Source:
    """One entry of the catalogue, with the user's argument and address in place."""
    name: str  #: as the user wrote it, for messages and the provenance
    key: str  #: of the catalogue
    argument: str  #: what followed the colon
    entry: dict
    base: str
    hosts: set = field(default_factory=set)  #: that may be asked

    @property
    def kind(self):
        return self.entry["kind"]

    def __getitem__(self, key):
        return self.entry.get(key)


def read():
    with open(FILE, "rb") as stream:
        return tomllib.load(stream)


def names(catalogue):
    return [f"{key}:{entry['argument']}" if "argument" in entry else key for key, entry in catalogue.items()]


def find(word, base_url=None, more_hosts=()):
    """The source that "copernicus-glo30" or "opentopography:NASADEM" means; UserError where none does."""
    catalogue = read()
    key, colon, argument = word.partition(":")
    if key not in catalogue:
        near = difflib.get_close_matches(word, names(catalogue), 1, 0.6)
        hint = f"did you mean '{near[0]}'? " if near else ""
        raise UserError(f"unknown source '{word}'; {hint}there are: {', '.join(names(catalogue))}")
    entry = catalogue[key]
    wanted = entry.get("argument")
    if wanted and not argument:
        raise UserError(f"source '{key}' needs more: {key}:{wanted}{_choice(entry)}")
    if colon and not wanted:
        raise UserError(f"source '{key}' takes nothing after a colon, not '{argument}'")
    if "datasets" in entry:
        entry = _with_dataset(key, entry, argument)
    base = base_url or os.environ.get(variable(key)) or entry.get("base", "")
    source = Source(word, key, argument, entry, base.rstrip("/"))
    if key == "hgt":
        source.base = argument
    if source.base:
        source.hosts.add(host_of(source.base))
    source.hosts.update([*entry.get("hosts", ()), *more_hosts])
    return source


def variable(key):
    """Name of the environment variable that replaces a source's address."""
    return "THALWEG_URL_" + key.upper().replace("-", "_")


def host_of(url):
    """host or host:port of an http(s) address; UserError for anything else, and for credentials in it."""
    try:
        parts = urlsplit(url)
        port = parts.port
    except ValueError:
        raise UserError("an address of the source is not valid") from None
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise UserError(f"'{url.split('@')[-1].split('?')[0]}' is no http:// or https:// address")
    if parts.username or parts.password:
        raise UserError(f"the address on {parts.hostname} holds a user or password: these are never taken from an address")
    return parts.hostname + (f":{port}" if port else "")


def _choice(entry):
    return " with one of " + ", ".join(entry["datasets"]) if "datasets" in entry else ""


def _with_dataset(key, entry, dataset):
    known = entry["datasets"]
    if dataset not in known:
        near = difflib.get_close_matches(dataset.upper(), known, 1, 0.5)
        hint = f"did you mean '{near[0]}'? " if near else ""
        raise UserError(f"source '{key}' has no dataset '{dataset}'; {hint}there are: {', '.join(known)}")
    merged = {**entry, **known[dataset]}
    merged["title"] = entry["title"].format(dataset_title=known[dataset]["title"])
    merged["citation"] = f"{known[dataset]['citation']}; {entry['citation']}"
    return merged
