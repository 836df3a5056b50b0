"""The module itself: its version, its stubs, its errors, the code of its page."""

import ast
import importlib.util
import inspect
import pathlib
import re

import pytest

import twinchute
from conftest import SOURCE

STUBS = pathlib.Path(twinchute.__file__).with_suffix(".pyi")


def stubs():
    return ast.parse(STUBS.read_text()).body


def shown(names):
    """Those of users."""
    return {name for name in names if not name.startswith("_")}


def test_version_is_that_of_the_program(program):
    assert program("--version")[1].splitlines()[0] == f"twinchute {twinchute.__version__}"


def test_stubs_name_what_the_module_has():
    functions = {node.name for node in stubs() if isinstance(node, ast.FunctionDef)}
    classes = {node.name for node in stubs() if isinstance(node, ast.ClassDef)}
    values = {node.target.id for node in stubs() if isinstance(node, ast.AnnAssign)}
    assert functions | classes | values == set(twinchute.__all__)
    assert shown(name for name in dir(twinchute) if not inspect.ismodule(getattr(twinchute, name))) == shown(twinchute.__all__)


@pytest.mark.parametrize("name", [node.name for node in stubs() if isinstance(node, ast.ClassDef)])
def test_stubs_name_the_members_of_a_class(name):
    node = next(node for node in stubs() if isinstance(node, ast.ClassDef) and node.name == name)
    named = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
    fields = {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
    own = vars(getattr(twinchute, name))
    assert shown(named) | (fields & shown(own)) == shown(own)
    for method in named:
        assert hasattr(getattr(twinchute, name), method), method


def parameters(function):
    """Names of the parameters, of a compiled function those of its docstring."""
    if inspect.isfunction(function):
        return list(inspect.signature(function).parameters)
    signature = function.__doc__.splitlines()[0]
    inside = signature[signature.index("(") + 1 : signature.rindex(") ->")]
    return re.findall(r"(?:^|, )(\w+):", inside)


@pytest.mark.parametrize("node", [node for node in stubs() if isinstance(node, ast.FunctionDef)], ids=lambda node: node.name)
def test_stubs_name_the_parameters_of_a_function(node):
    assert parameters(getattr(twinchute, node.name)) == [argument.arg for argument in node.args.args]


@pytest.mark.parametrize("name", sorted(shown(twinchute.__all__) - {"statuses"}))
def test_everything_says_what_it_is(name):
    thing = getattr(twinchute, name)
    assert thing.__doc__
    for member, value in vars(thing).items() if inspect.isclass(thing) and thing.__module__ == "twinchute" else ():
        if isinstance(value, property):
            assert value.__doc__, f"{name}.{member}"


def test_every_status_has_its_code():
    # The order is that of StatusCode, which records of campaigns hold.
    assert twinchute.statuses[0] == "completed" and "refused" in twinchute.statuses


def test_the_code_of_the_page_runs(tmp_path, monkeypatch, capsys):
    """Block after block in one interpreter, in a directory where the data lie as in the tree."""
    (tmp_path / "data").symlink_to(SOURCE / "data")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    page = (SOURCE / "docs/guide/python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    assert len(blocks) >= 8
    names = {}
    for block in blocks:
        if "matplotlib" in block and importlib.util.find_spec("matplotlib") is None:
            continue
        said = re.findall(r"^ *print\(.*\)  # (.*)$", block, flags=re.MULTILINE)
        capsys.readouterr()
        exec(compile(block, "docs/guide/python.md", "exec"), names)  # pylint: disable=exec-used
        # What the page says beside a print is what it prints.
        assert capsys.readouterr().out.splitlines() == said
    assert (tmp_path / "drop.out/summary.json").exists()
