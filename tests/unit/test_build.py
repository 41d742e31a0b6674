import asyncio
import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest
from kept_cache import link_engines
from places import BUNDLES
from processes import COMMAND_S, HANG_S, until_ended
from projects import bundle_project, text_project
from scripted_models import json_text, lowered

from aos_protocol.errors import ModelError
from aos_solver.building import build as build_module
from aos_solver.building import engine_build as engine_build_module
from aos_solver.building.build import BuiltModel, build
from aos_solver.building.build_cache import BuildCache
from aos_solver.building.compiler import Compiler, find_compiler
from aos_solver.building.engine_build import ANY_SIZE, QUICK, SOURCES, SUPPORT, build_engine, engine_name
from aos_solver.emission.emit import EmittedModel

HOME = """project: test
horizon: 3
discount: 0.9
state_variable: int total
"""


BEING_BUILT = f"*.{os.getpid()}.*.building"
"""Entries that this process makes."""


@pytest.fixture(scope="module")
def cache_dir(cache_dir: Path, tmp_path_factory) -> Path:
    asyncio.run(build_engine(cache_dir))
    fresh = tmp_path_factory.mktemp("cache")
    link_engines(cache_dir, fresh)
    return fresh


def emitted_skill(code: str, home: str = HOME) -> EmittedModel:
    act = f"project: test\ndynamic_model:\n{code}\n"
    return lowered(text_project({"home.ef": home, "act.sd": act}))[0]


async def build_error(emitted: EmittedModel, cache_dir: Path) -> ModelError:
    with pytest.raises(ModelError) as raised:
        await build(emitted, cache_dir=cache_dir)
    return raised.value


def places(error: ModelError) -> list[str]:
    return [str(diagnostic.span) for diagnostic in error.diagnostics]


async def test_a_model_is_built_once_which_is_told_and_then_found(cache_dir: Path):
    emitted, _ = lowered(bundle_project(BUNDLES / "armadillo-finer"))
    told: list[str] = []
    first = await build(emitted, cache_dir=cache_dir, on_progress=told.append)
    assert told[0].startswith(f"compiling {emitted.project} with ")
    assert told[-1].startswith(f"compiled {emitted.project} in ")
    told.clear()
    second = await build(emitted, cache_dir=cache_dir, on_progress=told.append)
    assert second.executable == first.executable
    assert not told
    assert (second.executable.parent / "model.cpp").read_text() == emitted.cpp


async def test_who_waits_for_another_build_is_told_that_it_makes_the_engine_too(tmp_path):
    emitted = emitted_skill("state__.total += 1;")
    has_begun = asyncio.Event()
    first = build(emitted, cache_dir=tmp_path, on_progress=lambda _: has_begun.set())
    told: asyncio.Queue[str] = asyncio.Queue()
    async with asyncio.TaskGroup() as tasks:
        builds = [tasks.create_task(first)]
        await has_begun.wait()
        builds.append(tasks.create_task(build(emitted, cache_dir=tmp_path, on_progress=told.put_nowait)))
        assert "which another process compiles, with the engine: once for all" in await told.get()
        for each in builds:
            each.cancel()


async def test_two_builds_of_one_model_at_the_same_time_give_one_entry(cache_dir: Path):
    emitted = emitted_skill("state__.total += 1;")
    async with asyncio.TaskGroup() as tasks:
        both = [tasks.create_task(build(emitted, cache_dir=cache_dir)) for _ in range(2)]
    first, second = (task.result() for task in both)
    assert first.executable == second.executable
    assert entries(cache_dir, BEING_BUILT) == []
    assert await answers(first)


@pytest.mark.parametrize(
    ("length", "ready", "chosen"),
    [
        (40, {64}, 256),
        (40, {64, 256, ANY_SIZE}, 256),
        (40, {64, ANY_SIZE}, ANY_SIZE),  # rather than compile the other one first
        (400, {64, 256}, ANY_SIZE),
    ],
)
async def test_a_large_state_gets_the_quickest_engine_that_is_ready(
    length, ready, chosen, cache_dir: Path, monkeypatch
):
    usual = await build_engine(cache_dir)
    compiler = await find_compiler()
    names = {engine_name(compiler, size) for size in ready}
    sizes: list[int] = []

    async def recorded(*_: Any, state_bytes: int, **__: Any) -> Path:
        sizes.append(state_bytes)
        return usual

    monkeypatch.setattr(build_module, "build_engine", recorded)
    monkeypatch.setattr(BuildCache, "find", lambda _, name: usual if name in names else None)
    row = f"state_variable: int row []\ncode:\nstate.row = vector<int>({length}, 0);\n"
    step = f"state__.row[3] = {len(ready)};"
    await build(emitted_skill(step, HOME + row), cache_dir=cache_dir)
    assert sizes == [64, chosen]


@pytest.mark.parametrize(("processors", "gigabytes", "at_once"), [(2, 8, 2), (2, 1, 1), (1, 8, 1), (4, 4, 2)])
async def test_an_engine_has_a_compiler_for_each_processor_and_its_longest_part_begins(
    tmp_path, monkeypatch, processors, gigabytes, at_once
):
    begun: list[str] = []
    ended: list[str] = []
    most = 0

    async def compiled(_: Compiler, command: list[str], *__: Any, **___: Any) -> tuple[str, int]:
        nonlocal most
        begun.append(Path(command[-1]).name)
        most = max(most, len(begun) - len(ended))
        await asyncio.sleep(0)
        ended.append(begun[-1])
        return "", 0

    monkeypatch.setattr(engine_build_module, "run_compiler", compiled)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(processors)))
    monkeypatch.setattr(os, "sysconf", {"SC_PAGE_SIZE": 1 << 10, "SC_PHYS_PAGES": gigabytes << 20}.get)
    await build_engine(tmp_path)
    assert (begun[:2], len(ended), most) == (["engine.o", "numbers.o"], 4, at_once)


async def test_a_part_of_the_engine_that_fails_stops_the_others(tmp_path, monkeypatch):
    ended: list[str] = []

    async def compiled(_: Compiler, command: list[str], *__: Any, **___: Any) -> tuple[str, int]:
        if command[-1] == "engine.o":
            await asyncio.sleep(600)
            ended.append(command[-1])
        return "g++: fatal error: Killed signal terminated program cc1plus", 1

    monkeypatch.setattr(engine_build_module, "run_compiler", compiled)
    monkeypatch.setattr(engine_build_module, "_at_once", lambda: 2)
    with pytest.raises(ModelError, match="Killed signal") as caught:
        await build_engine(tmp_path)
    assert "machine is too busy or too small" in str(caught.value.hint)
    assert not ended


async def test_a_mistake_in_sdl_is_told_with_line_and_column(cache_dir: Path):
    error = await build_error(
        emitted_skill("int number = 1;\n\tstate__.total = numbr + 1;\n\n__reward = missing(number)"),
        cache_dir,
    )
    assert error.code == "AOS201"
    assert places(error) == ["act.sd:4:18", "act.sd:6:12"]
    # g++ suggests another name, clang gives no suggestion in templates.
    assert (error.diagnostics[0].message, error.diagnostics[0].hint) in (
        ("`numbr` was not declared", "Did you mean `number`?"),
        ("use of undeclared identifier `numbr`", ""),
    )


async def test_a_number_with_a_unit_is_told_without_the_compilers_words(cache_dir: Path):
    error = await build_error(emitted_skill("int length = 5m;"), cache_dir)
    (only,) = error.diagnostics
    assert only.message == "a number cannot have `m` behind it"


NO_VALUE = "this cannot be set to a value of that type"
"""Clang names no types where a value is refused."""
OTHER_KEYS = "the keys of this map variable are {Side, (0,3,1)}, and these are others"


@pytest.mark.parametrize(
    ("code", "column", "by_gcc", "by_clang"),
    [
        ("state.load = 3;", 14, "a map variable takes no value as a whole", NO_VALUE),
        ("state.load[{par2, par1}] = 3;", 11, OTHER_KEYS, OTHER_KEYS),
        ("state.load[par1] = 3;", 11, OTHER_KEYS, OTHER_KEYS),
        (
            "state.load.total = 3;",
            12,
            "`map of int` has no member named `total`",
            "no member named `total` in `map of int`",
        ),
    ],
)
async def test_a_mistake_with_a_map_names_its_keys(code, column, by_gcc, by_clang, cache_dir: Path):
    declared = (
        "define_type: Side\nenum_members: Left, Right\n\nstate_variable: int load\nkey_types: Side, (0,3,1)\n"
    )
    home = f"{HOME}\n{declared}code:\n{code}\n"
    error = await build_error(emitted_skill("state__.total = 1;", home), cache_dir)
    (only,) = error.diagnostics
    assert only.message == await said(by_gcc, by_clang)
    assert only.span.line == home.split("\n").index(code) + 1
    if only.message == NO_VALUE:
        return
    name = await said("NAME" if "total" in code else "load", "NAME")
    assert only.span.column == column
    assert (
        only.hint == f"An element of it is `state.{name}[{{...}}]`, with a key for each of {{Side, (0,3,1)}}"
    )


@pytest.mark.parametrize(
    ("code", "by_gcc", "by_clang"),
    [
        ("state__.row = 3;", "`vector<int>` cannot be set to `int`", NO_VALUE),
        (
            "state__.row = {Left, 2.5, missing};",
            "`missing` was not declared",
            "use of undeclared identifier `missing`",
        ),
        ("Side one = 1;", *["a number is no value of Side"] * 2),
        ("state__.at(Left) = 2;", "this is an array, and no function", "this is an array, and no function"),
        (
            "std::pair<int, std::string> p; p = {1};",
            "`std::pair<int, std::string >` cannot be set to a list in braces",
            NO_VALUE,
        ),
        (
            "auto set = [](int& x) { x = 1; }; set(state.row[0]);",
            "`int&` may change what it is given, and this is only read",
            "no matching function for call to object of type a lambda",
        ),
        (
            "bool a = true\nbool b = a;\nstate__.total = b;",
            "expected `,` or `;` before `bool`",
            "expected `;` at end of declaration",
        ),
    ],
)
async def test_types_are_told_by_their_names_in_documents(code, by_gcc, by_clang, cache_dir: Path):
    side = "define_type: Side\nenum_members: Left, Right\n\n"
    variables = "state_variable: int at [Side]\n\nstate_variable: int row []\ncode:\nstate.row = {1, 2};\n"
    error = await build_error(emitted_skill(code, f"{HOME}\n{side}{variables}"), cache_dir)
    (only,) = error.diagnostics
    hint = "An element of it has square brackets: `[i]`" if "an array" in by_gcc else ""
    if "a number" in by_gcc:
        hint = "Write `(Side)` before it; a draw is `AOS.SampleDiscrete(Side, {...})`"
    if only.message.endswith("only read"):
        hint = "Write `const int&`, or give a copy of the state that may change here"
    if only.message.endswith("before `bool`"):
        hint = "Is a semicolon missing at the end of the line above?"
    assert (only.message, only.hint) == (await said(by_gcc, by_clang), hint)


@pytest.mark.parametrize(("values", "types"), [("1", "int"), ("2.5, 1", "double, int")])
async def test_a_list_of_other_parameters_is_told_with_those_of_the_skill(values, types, cache_dir: Path):
    listed = f"__possibleParameters.push_back(std::make_tuple({values}));"
    code = (
        f"state__.total = 1;\n\nparameter: int a\nparameter: string b\n\navailable_parameters_code:\n{listed}"
    )
    error = await build_error(emitted_skill(code), cache_dir)
    (only,) = error.diagnostics
    by_gcc = f"the parameters of this skill are (int, std::string), and these values are ({types})"
    assert only.message == await said(by_gcc, "no matching member function for call to `push_back`")
    assert str(only.span).startswith("act.sd:9:")


@pytest.mark.parametrize(
    ("code", "by_gcc", "by_clang"),
    [
        ("class P { int a; }; P p; p.a = 3;", "`P::a` is private", "`a` is private"),
        ("class P { void f() {} }; P p; p.f();", "`P::f` is private", "`f` is private"),
        (
            "vector<int> v{2, 1}; std::sort(v);",
            *["`sort` takes a beginning and an end, and no container"] * 2,
        ),
        (
            "double d = std::max(0, state.total * 0.5); state__.total = d;",
            "`max` compares values of one type, and these are int and double",
            "no matching function for call to `max`",
        ),
        (
            "struct S { int n; }; S s; S* p = &s; p.n = 1;",
            "`p` is a pointer",
            "a value of type `S *` is a pointer",
        ),
        (
            "int n; n = {1, 2};",
            "`int` cannot be set to a list in braces",
            "excess elements in scalar initializer",
        ),
        (
            "int k = 1; auto f = [](int n) { return n + k; }; f(2);",
            "`k` is not captured by this lambda",
            "`k` is not captured by this lambda",
        ),
        (
            "std::map<int, std::pair<int, int>> m{{1, {2, 3}}}; state__.total = m.at(1).fist;",
            "`std::pair<int, int>` has no member named `fist`",
            "no member named `fist` in `std::pair<int, int>`",
        ),
        (
            "struct S { int n; }; S s; s->n = 1;",
            "base operand of `->` has non-pointer type `S`",
            "member reference type `S` is not a pointer",
        ),
        ("int n = 1; state__.total = n[0];", *["this is one value, and has no elements"] * 2),
        ("Bool ok = true;\nstate__.total = ok;", "`Bool` was not declared", "unknown type name `Bool`"),
        (
            "auto f = [](std::optional<Spot> p) {\nreturn p ? 1 : 0; };\nf(std::nullopt);",
            "`Spot` was not declared",
            "use of undeclared identifier `Spot`",
        ),
    ],
)
async def test_what_is_said_of_classes_and_the_library_is_told_in_words(
    code: str, by_gcc: str, by_clang: str, cache_dir: Path
):
    error = await build_error(emitted_skill(code), cache_dir)
    assert [one.message for one in error.diagnostics] == [await said(by_gcc, by_clang)]


async def said(by_gcc: str, by_clang: str) -> str:
    """Returns what the compiler that is found is expected to say."""
    return by_gcc if (await find_compiler()).family == "gcc" else by_clang


async def test_mistakes_in_json_are_told_inside_their_strings(cache_dir: Path):
    document: dict[str, Any] = {
        "Preconditions": {"GlobalVariablePreconditionAssignments": [
            {"AssignmentCode": "int a = 1;\nint b = \"two\";\n__meetPrecondition = a > b;"}
        ]},
        "DynamicModel": {"NextStateAssignments": [
            {"AssignmentCode": ["state__.total = 1;", "", "state__.total = AOS.Bernouli(0.5);"]},
        ]},
    }  # fmt: skip
    text = json_text(document, "PLP", "act")
    # The registry knows the built-ins; the compiler has the last word about documents that it did not read.
    project = text_project({"home.ef": HOME, "act.json": text.replace("Bernouli", "Bernoulli")})
    error = await build_error(lowered(project)[0], cache_dir)
    line = next(n for n, content in enumerate(text.split("\n"), 1) if "int a" in content)
    # g++ points at the value, clang at the variable.
    columns = [text.split("\n")[line - 1].index(mark) + 1 for mark in ('\\"two', "b =")]
    assert places(error)[0] in [f"act.json:{line}:{column}" for column in columns]
    assert len(places(error)) == 1


async def test_a_mistake_in_a_template_that_code_uses_is_told_where_it_is_used(cache_dir: Path):
    error = await build_error(emitted_skill("vector<int> v{3, 1};\nstd::sort(v.begin(), 7);"), cache_dir)
    assert places(error)[0].startswith("act.sd:4:")


async def test_an_error_outside_the_documents_names_the_emitted_file(cache_dir: Path):
    emitted = emitted_skill("state__.total = 5;")
    broken = EmittedModel(
        emitted.project,
        emitted.cpp.replace("namespace model {", "namespace model { Unheard of;"),
        emitted.digest,
        emitted.state_digest,
        emitted.snippets,
        emitted.pieces,
        emitted.origins,
    )
    error = await build_error(broken, cache_dir)
    assert error.diagnostics == ()
    assert "Unheard" in error.message
    kept = Path(error.hint.rsplit(" ", 1)[-1])
    assert "Unheard of;" in text_of(kept)


async def test_a_compiler_that_does_not_finish_is_stopped_and_leaves_nothing(tmp_path, monkeypatch):
    pids, cache, scratch = tmp_path / "pids", tmp_path / "cache", tmp_path / "scratch"
    pids.touch()
    scratch.mkdir()
    monkeypatch.setenv("TMPDIR", str(scratch))
    endless = Compiler(("sh", "-c", f"mktemp; echo $$ >> {pids}; exec sleep 1000"), "gcc", "endless")
    emitted = emitted_skill("state__.total = 6;")
    with pytest.raises(ModelError, match=r"did not finish .* within 0\.3 s") as raised:
        await build(emitted, cache_dir=cache, compiler=endless, deadline_s=0.3)
    assert raised.value.code == "AOS202"
    assert (entries(cache), entries(scratch)) == ([], [])
    await until_ended([int(pid) for pid in pids.read_text().split()])


async def test_a_failed_build_leaves_nothing_that_could_be_taken_for_a_model(tmp_path):
    async def fail(staging: Path):
        (staging / "half").write_text("half")
        raise ModelError("no")

    with pytest.raises(ModelError):
        await BuildCache(tmp_path).fill("entry", fail)
    assert entries(tmp_path) == []


async def test_what_models_include_is_compiled_once_and_changes_nothing(
    cache_dir: Path, tmp_path, monkeypatch
):
    compiler = await find_compiler()
    engine = await build_engine(cache_dir)
    (tmp_path / "model.cpp").write_text(emitted_skill("state__.total += 7;").cpp)
    objects = []
    for more in ([], compiler.precompiled(SUPPORT, str(engine))):
        options = [*QUICK, *more, "-H"]
        command = compiler.compilation("model.cpp", "model.o", str(SOURCES), *options)
        done = await asyncio.to_thread(
            subprocess.run,
            command,
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=True,
            timeout=COMMAND_S,
        )
        assert ("/aos/base/" in done.stderr) == (not more), done.stderr
        objects.append((tmp_path / "model.o").read_bytes())
    assert objects[0] == objects[1]


def entries(cache_dir: Path, pattern: str = "*") -> list[Path]:
    return list(cache_dir.glob(pattern))


def text_of(path: Path) -> str:
    return path.read_text()


async def answers(built: BuiltModel) -> dict[str, Any]:
    child = await asyncio.create_subprocess_exec(
        built.executable, "/dev/null", "/dev/null", "1", "widen", "12",
        stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.PIPE,
    )  # fmt: skip
    async with asyncio.timeout(HANG_S):
        output, _ = await child.communicate()
    described: dict[str, Any] = json.loads(output.splitlines()[0])
    return described
