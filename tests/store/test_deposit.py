"""A deposit can be used alone and is valid; an upload is published whole or not at all."""

import hashlib
import http.server
import json
import shutil
import threading
import zipfile

import pytest
from rocrate.rocrate import ROCrate

from squealpipe.cli import run as command
from squealpipe.store.archive import archive, verify
from squealpipe.store.checkout import ROOT
from squealpipe.store.memory.deposit import bundle, check


@pytest.fixture
def checkout(run, monkeypatch):
    """A checkout with one archive and what else a deposit needs."""
    for name in ("CITATION.cff", "LICENSE", "Snakefile", "pyproject.toml", "requirements.lock"):
        shutil.copy(ROOT / name, run / name)
    archive("first", root=run)
    monkeypatch.chdir(run)
    monkeypatch.setenv("ZENODO_TOKEN", "secret")
    return run


def unpacked(path, folder):
    with zipfile.ZipFile(path) as file:
        file.extractall(folder)
    return folder / "first"


@pytest.fixture
def deposit(checkout, tmp_path):
    return unpacked(bundle("first")[0], tmp_path / "elsewhere")


def test_a_deposit_is_whole_and_valid(deposit):
    assert check(deposit) == []
    assert verify(deposit / "run").intact
    for name in ("run/data/stability_map.nc", "run/figures/fig06.png", "run/config/resolved.yaml",
                 "code/Snakefile", "code/requirements.lock", "CITATION.cff"):  # fmt: skip
        assert (deposit / name).is_file()
    zenodo = json.loads((deposit / ".zenodo.json").read_text())
    datacite = json.loads((deposit / "datacite.json").read_text())
    assert zenodo["title"] == datacite["titles"][0]["title"]
    assert zenodo["license"] == datacite["rightsList"][0]["rightsIdentifier"] == "MIT"


def test_the_crate_tells_the_run_of_each_dataset(deposit):
    crate = ROCrate(deposit)
    assert crate.mainEntity.id == "code/Snakefile"
    assert "ComputationalWorkflow" in crate.mainEntity.type
    run = crate.get("#run-stability_map")
    assert run.type == "CreateAction"
    assert [item.id for item in run["result"]] == ["run/data/stability_map.nc"]
    assert json.loads(run["object"][0]["value"])["parameters"]["mu"] == 0.3
    assert run["instrument"]["name"] == "squealpipe"
    profiles = [item.id for item in crate.root_dataset["conformsTo"]]
    assert "https://w3id.org/ro/wfrun/workflow/0.5" in profiles


def test_equal_archives_give_equal_bundles(checkout):
    first = bundle("first", output="a.zip")[0].read_bytes()
    assert bundle("first", output="b.zip")[0].read_bytes() == first


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("datacite.json", "{}"),
        (".zenodo.json", '{"title": ""}'),
        ("CITATION.cff", "title: x"),
        ("run/figures/fig06.png", "another"),
        ("code/Snakefile", "another"),
        ("code/new.py", "not described"),
    ],
)
def test_the_check_finds_faults(deposit, name, content):
    (deposit / name).write_text(content)
    assert any(name.removeprefix("run/") in fault for fault in check(deposit))


def test_a_damaged_archive_or_one_without_authors_is_not_bundled(checkout):
    (checkout / "CITATION.cff").write_text("title: t\nlicense: MIT\nauthors: []\nversion: '1'\n")
    with pytest.raises(ValueError, match="not valid"):
        bundle("first")
    shutil.copy(ROOT / "CITATION.cff", checkout / "CITATION.cff")
    path = checkout / "results/archive/first/figures/fig06.png"
    path.unlink()
    with pytest.raises(ValueError, match=r"missing: figures/fig06\.png"):
        bundle("first")
    assert not (checkout / "results/deposit/first.zip").exists()
    assert not list((checkout / "results/deposit").glob(".deposit.*"))


class Service(http.server.BaseHTTPRequestHandler):
    """Zenodo's interface as far as it is used, with faults on request."""

    def log_message(self, *_):
        pass

    def _act(self):
        state, kind = self.server.state, self.command
        size = int(self.headers.get("Content-Length") or 0)
        step = (
            "publish" if "/publish/" in self.path
            else "bucket" if "/bucket/" in self.path
            else {"POST": "create", "PUT": "metadata", "DELETE": "delete"}[kind]
        )  # fmt: skip
        state["steps"].append(step)
        assert self.headers["Authorization"] == "Bearer secret"
        fault = state["faults"].get(step)
        if fault == "cut":
            self.rfile.read(min(size, 1000))
            self.close_connection = True
            return
        body = self.rfile.read(size)
        if fault:
            self.send_error(fault)
            return
        base = f"http://127.0.0.1:{self.server.server_port}/api"
        if step == "publish":
            state["published"] = True
        if step == "delete":
            state["drafts"] -= 1
        if step == "create":
            state["drafts"] += 1
        checksum = "0" if state["faults"].get("bytes") else hashlib.md5(body).hexdigest()  # noqa: S324
        links = {name: f"{base}/{name}/7" for name in ("self", "bucket", "publish", "html")}
        answer = json.dumps({"links": links, "checksum": f"md5:{checksum}"}).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(answer)))
        self.end_headers()
        self.wfile.write(answer)

    do_GET = do_POST = do_PUT = do_DELETE = _act  # noqa: N815


@pytest.fixture
def service():
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Service)
    server.state = {"steps": [], "faults": {}, "drafts": 0, "published": False}
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def send(service, *options):
    return command(
        ["deposit", "first", *options, "--api", f"http://127.0.0.1:{service.server_port}/api"]
    )


def test_an_upload_is_a_draft_until_publication_is_asked_for(checkout, service, capsys):
    assert send(service, "--upload") == 0
    assert service.state["steps"] == ["create", "bucket", "metadata"]
    assert not service.state["published"]
    assert send(service, "--publish") == 0
    assert service.state["published"]
    assert "published: http://" in capsys.readouterr().out


@pytest.mark.parametrize("fault", [413, 500, "cut"])
@pytest.mark.parametrize("step", ["create", "bucket", "metadata"])
def test_a_failed_upload_publishes_nothing_and_says_so(checkout, service, capsys, step, fault):
    service.state["faults"][step] = fault
    assert send(service, "--publish") == 2
    assert service.state["steps"].count(step) >= 1
    assert "publish" not in service.state["steps"]
    assert not service.state["published"]
    assert service.state["drafts"] == 0
    error = capsys.readouterr().err
    assert "Traceback" not in error
    assert "secret" not in error


def test_other_bytes_than_were_sent_are_not_published(checkout, service, capsys):
    service.state["faults"]["bytes"] = True
    assert send(service, "--publish") == 2
    assert "received other bytes" in capsys.readouterr().err
    assert (service.state["published"], service.state["drafts"]) == (False, 0)


def test_a_draft_that_cannot_be_deleted_is_told(checkout, service, capsys):
    service.state["faults"] |= {"bucket": 500, "delete": 500}
    assert send(service, "--upload") == 2
    assert "an unpublished draft is left at http://" in capsys.readouterr().err


def test_a_failed_publication_is_told_as_unknown(checkout, service, capsys):
    service.state["faults"]["publish"] = "cut"
    assert send(service, "--publish") == 2
    assert "is not known" in capsys.readouterr().err


def test_without_a_token_nothing_is_done(checkout, service, monkeypatch, capsys):
    monkeypatch.delenv("ZENODO_TOKEN")
    assert send(service, "--upload") == 2
    assert "ZENODO_TOKEN is not set" in capsys.readouterr().err
    assert service.state["steps"] == []
    assert not (checkout / "results/deposit").exists()


def test_a_dry_run_needs_no_network(checkout, monkeypatch, capsys):
    def refuse(*_, **__):
        raise AssertionError("the network was used")

    monkeypatch.setattr("socket.socket.connect", refuse)
    assert command(["deposit", "first"]) == 0
    assert "results/deposit/first.zip" in capsys.readouterr().out
