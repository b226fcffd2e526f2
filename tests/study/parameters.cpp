// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/parameters.hpp"

#include <catch2/catch.hpp>
#include <fstream>

#include "support/temp_folder.hpp"
#include "thalweg/study/growth_site.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::error_of;
using test::TempFolder;

namespace {

Experiment read(const std::string& toml, const std::vector<std::string>& overrides = {}) {
    const TempFolder folder;
    return read_experiment(folder.text("experiment.toml", toml), overrides);
}

std::string refusal(const std::string& toml, const std::vector<std::string>& overrides = {}) {
    return error_of([&] { read(toml, overrides); });
}

}  // namespace

TEST_CASE("An empty experiment file gives the documented defaults") {
    const Experiment e = read("");
    CHECK(e.seed == 1);
    CHECK_FALSE(e.outlets);
    CHECK_FALSE(e.river.k);
    CHECK(e.river.n == 1);
    CHECK(e.river.receiver == terrain::Receiver::steepest);
    CHECK_FALSE(e.hillslope.talus_angle_deg);
    CHECK(e.time.solver == Solver::implicit);
    CHECK(e.time.convergence == 1e-3);
    CHECK(e.initial.amplitude_m == 0.01);
}

TEST_CASE("Every key that is set arrives, whole numbers standing for real ones") {
    const Experiment e = read(R"(
seed = 7
outlets = "all"
[domain]
size_m = [20000, 10000.5]
nodes = 2000
mesh = "raster"
[uplift]
rate_m_per_yr = 1
pattern = "radial"
[river]
k = 2e-5
m = 0.4
n = 2
receiver = "lowest"
[hillslope]
talus_angle_deg = 35
[time]
solver = "steady"
max_steps = 1e3
[output]
resolution = 256
interpolation = "natural"
heightmap = "png"
mesh_file = "ply"
solid = true
)");
    CHECK(e.seed == 7);
    CHECK(e.outlets == Outlets{});
    CHECK(e.domain.size_m == std::vector<double>{20000, 10000.5});
    CHECK(e.domain.nodes == Index{2000});
    CHECK(e.domain.mesh == MeshKind::raster);
    CHECK(e.uplift.rate_m_per_yr == 1);
    CHECK(e.uplift.pattern == evolve::Pattern::radial);
    CHECK(e.river.k == 2e-5);
    CHECK(e.river.receiver == terrain::Receiver::lowest);
    CHECK(e.hillslope.talus_angle_deg == 35.0);
    CHECK(e.time.solver == Solver::steady);
    CHECK(e.time.max_steps == 1000);
    CHECK(e.output.resolution == Index{256});
    CHECK(e.output.interpolation == Interpolation::natural);
    CHECK(e.output.heightmap == HeightmapFile::png);
    CHECK(e.output.mesh_file == MeshFile::ply);
    CHECK(e.output.solid);
}

TEST_CASE("Overrides replace values and need no quotes") {
    const Experiment e =
        read("[river]\nk = 1e-6\n", {"river.k=2e-5", "time.solver=steady", "seed=9", "domain.size_m=[1, 2]"});
    CHECK(e.river.k == 2e-5);
    CHECK(e.time.solver == Solver::steady);
    CHECK(e.seed == 9);
    CHECK(e.domain.size_m == std::vector<double>{1, 2});
}

TEST_CASE("The resolved experiment reads back as the same experiment") {
    const Experiment first = read(R"(
seed = 3
outlets = "dem"
[domain]
dem = "some \"odd\" name.tif"
initial = "dem"
[river]
k = 1.2345678901234567e-7
m = 0.3333333333333333
[study]
uplift_m_per_yr = 3e-5
channel_area_m2 = 1e6
)");
    const TempFolder folder;
    const std::string text = to_toml(first);
    const Experiment second = read_experiment(folder.text("again.toml", text));
    CHECK(to_toml(second) == text);
    CHECK(second.river.k == first.river.k);
    CHECK(second.river.m == first.river.m);
    CHECK(second.domain.dem == first.domain.dem);
    CHECK(second.study.channel_area_m2 == 1e6);
}

TEST_CASE("Paths are relative to the experiment file") {
    const TempFolder folder;
    const Experiment e = read_experiment(folder.text("e.toml", "[domain]\ndem = \"data/x.tif\"\n"));
    CHECK(e.domain.dem == folder / "data/x.tif");
}

TEST_CASE("A source and a box read back as they were written, and must be a word and four degrees") {
    const Experiment e = read("[study]\nsource = \"opentopography:NASADEM\"\nbbox = [-84.5, 36, -84, 36.25]\n");
    CHECK(e.study.source == "opentopography:NASADEM");
    CHECK(e.study.bbox == std::array{-84.5, 36.0, -84.0, 36.25});
    const Experiment again = read(to_toml(e));
    CHECK(again.study.source == e.study.source);
    CHECK(again.study.bbox == e.study.bbox);
    CHECK(refusal("[study]\nsource = 3").find("study.source") != std::string::npos);
    CHECK(refusal("[study]\nbbox = [1, 2, 3]").find("four numbers") != std::string::npos);
    CHECK(refusal("[study]\nbbox = [1, 2, 300, 4]").find("180") != std::string::npos);
}

TEST_CASE("A path that is relative in memory is written as it is, one that was read from a file whole") {
    Experiment e = read("[domain]\ndem = \"x.tif\"");
    CHECK(e.domain.dem->is_absolute());
    e.domain.dem = "../fetch/x.tif";
    CHECK(to_toml(e).find("../fetch/x.tif") == to_toml(e).find("dem = ") + 7);
}

TEST_CASE("An unknown key is refused with the nearest one that exists") {
    CHECK(refusal("[river]\nerodability = 1\n").find("river.") != std::string::npos);
    CHECK(refusal("[river]\nkk = 1\n").find("'river.k'") != std::string::npos);
    CHECK(refusal("[tme]\nstep_yr = 1\n").find("unknown key 'tme'") != std::string::npos);
    CHECK(refusal("[domian]\nnodes = 50\n").find("did you mean 'domain'?") != std::string::npos);
    CHECK(refusal("domain = 5\n").find("write [domain]") != std::string::npos);
    CHECK(refusal("sed = 1\n").find("'seed'") != std::string::npos);
    CHECK(refusal("", {"river.erodability=1e-5"}).find("unknown key 'river.erodability'") != std::string::npos);
}

TEST_CASE("A wrong type or a value out of range is refused with one sentence that names the key") {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"river.k=-1", "river.k must be above 0"},
        {"river.k=0", "river.k must be above 0"},
        {"river.m=abc", "river.m must be a number"},
        {"river.k=nan", "river.k must be a finite number"},
        {"river.n=0.2", "river.n must be at least 0.3"},
        {"time.step_yr=inf", "time.step_yr must be a finite number"},
        {"domain.nodes=0", "domain.nodes must be at least 16"},
        {"domain.nodes=20.5", "domain.nodes must be a whole number"},
        {"domain.size_m=[1]", "domain.size_m must be two numbers"},
        {"domain.size_m=[1, -2]", "domain.size_m must be above 0"},
        {"domain.dem=3", "domain.dem must be a file name"},
        {"uplift.pattern=pyramid", "uplift.pattern must be \"constant\" or \"gradient\" or"},
        {"hillslope.talus_angle_deg=91", "hillslope.talus_angle_deg must be above 0 and at most 90"},
        {"seed=-1", "seed must be at least 0"},
        {"river=3", "unknown key"},
        {"nonsense", "--set needs key=value"},
        {"seed.inner=3", "is no section"},
    };
    for (const auto& [override_text, expected] : cases) {
        const std::string base = override_text == "seed.inner=3" ? "seed = 1\n" : "";
        INFO(override_text);
        const std::string said = refusal(base, {override_text});
        INFO(said);
        CHECK(said.find(expected) != std::string::npos);
        CHECK(test::is_sentence(said));
    }
}

TEST_CASE("A file that is missing or no TOML is refused, with the line where reading stopped") {
    CHECK(error_of([] { read_experiment("nowhere.toml"); }).find("no experiment file") != std::string::npos);
    CHECK(refusal("[river]\nk = = 3\n").find("line 2") != std::string::npos);
}

TEST_CASE("Every parameter has a text, a key of its own, and appears in the reference") {
    Experiment e;
    const std::string reference = experiment_reference();
    std::vector<std::string> keys;
    describe(e, [&](const Field& field, auto&) {
        keys.emplace_back(field.key);
        CHECK_FALSE(field.text.empty());
        CHECK(reference.find(std::string(field.key)) != std::string::npos);
    });
    std::sort(keys.begin(), keys.end());
    CHECK(std::adjacent_find(keys.begin(), keys.end()) == keys.end());
}

TEST_CASE("Outlets are a word, a list of sides or a share of the uplift, and are written as they were read") {
    CHECK(read("outlets = \"dem\"\n").outlets == Outlets{OutletRule::dem});
    CHECK(read("outlets = [\"north\", \"southeast\"]\n").outlets ==
          Outlets{OutletRule::sides, {Side::north, Side::southeast}});
    CHECK(read("", {"outlets=west"}).outlets == Outlets{OutletRule::sides, {Side::west}});
    CHECK(read("outlets = { uplift_below = 0.33 }\n").outlets == Outlets{OutletRule::uplift_below, {}, 0.33});
    for (const char* text : {"outlets = \"all\"\n", "outlets = \"dem\"\n", "outlets = [\"north\", \"southeast\"]\n",
                             "outlets = { uplift_below = 0.33 }\n"}) {
        CHECK(read(to_toml(read(text))).outlets == read(text).outlets);
    }
    for (const char* text : {"outlets = 3\n", "outlets = []\n", "outlets = [\"up\"]\n", "outlets = \"up\"\n",
                             "outlets = { uplift_below = -1 }\n", "outlets = { below = 1 }\n", "outlets = [3]\n"}) {
        INFO(text);
        CHECK(test::is_sentence(refusal(text)));
    }
}

TEST_CASE("Lines are one file or several, with one width and value or several, and are written as they were read") {
    const Experiment one = read("[uplift]\nlines = \"a.gpkg\"\nlines_width_m = 50\nlines_value = 0.2\n");
    CHECK(one.uplift.lines.size() == 1);
    CHECK(one.uplift.lines_width_m == std::vector<double>{50});
    const Experiment two =
        read("[rainfall]\nlines = [\"/a.gpkg\", \"/b.gpkg\"]\nlines_width_m = 50\nlines_value = [0.2, 3]\n");
    CHECK(two.rainfall.lines.size() == 2);
    CHECK(two.rainfall.lines_value == std::vector<double>{0.2, 3});
    const Experiment again = read(to_toml(two));
    CHECK(again.rainfall.lines == two.rainfall.lines);
    CHECK(again.rainfall.lines_value == two.rainfall.lines_value);
    CHECK(test::is_sentence(refusal("[uplift]\nlines_width_m = 0\n")));
    CHECK(test::is_sentence(refusal("[uplift]\nlines = 3\n")));
}

TEST_CASE("A basin and the dials of a network are read and written back as they were") {
    const std::string toml = R"(
seed = 9
[basin]
outline = [[0, 0], [8000.5, 500], [12000, 6000], [-2000, 4000]]
trunk = [[0, 0], [6500, 3500]]
base_level_m = 100
[growth]
channel_maintenance_m = 250
mean_junction = 0.4
flint_q = -0.5
upstream_link = "turns"
stop = "links"
tension_channel = 7
extra_tension_divide = 2
channel_width_m = 3
)";
    const Experiment e = read(toml);
    const Experiment again = read(to_toml(e));
    for (const Experiment* each : {&e, &again}) {
        CHECK(std::get<std::vector<Point>>(*each->basin.outline) ==
              std::vector<Point>{{0, 0}, {8000.5, 500}, {12000, 6000}, {-2000, 4000}});
        CHECK(std::get<std::vector<Point>>(*each->basin.trunk) == std::vector<Point>{{0, 0}, {6500, 3500}});
        CHECK(each->basin.base_level_m == 100);
        const grow::Dials dials = dials_of(*each);
        CHECK(dials.channel_maintenance_m == 250);
        CHECK(dials.seed == 9);
        CHECK(dials.mean_junction == 0.4);
        CHECK(dials.flint.q == -0.5);
        CHECK(dials.upstream_link == grow::UpstreamLink::turns);
        CHECK(dials.stop == grow::Stop::links);
        CHECK(each->growth.tension_channel == 7);
        CHECK(each->growth.extra_tension_divide == 2);
        CHECK(each->growth.channel_width_m == 3);
    }
    CHECK(to_toml(again) == to_toml(e));
    const Experiment filed = read("[basin]\noutline = \"basin.geojson\"");
    CHECK(std::get<std::filesystem::path>(*filed.basin.outline).filename() == "basin.geojson");
}

TEST_CASE("A basin or a dial that cannot be is refused by its name") {
    const auto refused = [](const std::string& toml, const std::string& why) {
        CHECK_THAT(refusal(toml), Catch::EndsWith(why));
    };
    refused("[basin]\noutline = [[0, 0], [1]]",
            "basin.outline must be a list of places [[x, y], …] or a file name in quotes, not [ [ 0, 0 ], [ 1 ] ]");
    refused("[basin]\noutline = [0, 1]",
            "basin.outline must be a list of places [[x, y], …] or a file name in quotes, not [ 0, 1 ]");
    refused("[basin]\ntrunk = 7", "basin.trunk must be a file name in quotes, not 7");
    refused("[basin]\noutline = [[0, nan], [1, 0], [1, 1]]", "basin.outline must be a finite number, not nan");
    refused("[growth]\nflint_q = 0.3", "growth.flint_q must be at least -2 and at most -0.05, not 0.3");
    refused("[growth]\nchannel_maintenance_m = 0",
            "growth.channel_maintenance_m must be above 0 and at most 1000000000, not 0");
    CHECK_THAT(error_of([] { dials_of({}); }), Catch::StartsWith("growth.channel_maintenance_m is needed"));
}

TEST_CASE("A study's models are one word or a list of different ones") {
    const auto models = [](const char* value) {
        const TempFolder folder;
        std::ofstream(folder / "a.toml") << "[study]\nmodels = " << value << "\n";
        return read_experiment(folder / "a.toml").study.models;
    };
    using enum StudyModel;
    CHECK(models("\"growth\"") == std::vector{growth});
    CHECK(models("[\"growth\", \"stream-power\"]") == std::vector{stream_power, growth});
    CHECK(Experiment{}.study.models == std::vector{stream_power});
    CHECK(error_of([&] { models("[]"); }).find("study.models") != std::string::npos);
    CHECK(error_of([&] { models("[\"growth\", \"growth\"]"); }).find("twice") != std::string::npos);
    CHECK(error_of([&] { models("[\"ice\"]"); }).find("stream-power") != std::string::npos);
}
