"""The command that adds an extra, in each kind of environment."""

import sys

import pytest

from dashpot.extensions.guidance import install_command

REQUIRED = ["numpy>=2", 'polars>=1.38; extra == "batch"', 'h11>=0.16; extra == "app"']


@pytest.fixture
def environment(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.setattr(sys, "executable", str(tmp_path / "bin" / "python"))
    monkeypatch.setattr(install_command, "requires", lambda _: REQUIRED)
    return tmp_path


def test_pip_adds_an_extra_to_the_environment_that_runs(environment, monkeypatch):
    monkeypatch.setattr(install_command, "find_spec", lambda _: object())
    message = install_command.format_install_command("batch")
    assert message == f"{environment}/bin/python -m pip install 'dashpot[batch]'"


def test_pipx_injects_what_the_extra_requires(environment):
    (environment / "pipx_metadata.json").touch()
    message = install_command.format_install_command("batch")
    assert message == f"pipx inject {environment.name} 'polars>=1.38'"


@pytest.mark.parametrize("receipt", [True, False])
def test_uv_installs_what_the_extra_requires(environment, monkeypatch, receipt):
    monkeypatch.setattr(install_command, "find_spec", lambda _: None)
    if receipt:
        (environment / "uv-receipt.toml").touch()
    message = install_command.format_install_command("app,batch")
    assert message == (f"uv pip install -p {environment}/bin/python 'polars>=1.38' 'h11>=0.16'")
