// SPDX-License-Identifier: GPL-3.0-or-later
// Options are described here and checked by the fetcher, which this program becomes: it runs by itself, too.
#include "thalweg/study/fetch.hpp"

#include <array>
#include <memory>

#include "command.hpp"
#include "interrupt.hpp"

namespace thalweg::tools {
namespace {

struct Option {
    const char* name;
    int values;  ///< words that follow; 0 for a flag
    const char* text;
};

constexpr std::array options{
    Option{"--bbox", 4, "west, south, east and north edge in degrees"},
    Option{"--point", 2, "longitude and latitude of a centre in degrees, with --radius-m"},
    Option{"--radius-m", 1, "distance around --point; the box that holds the circle is fetched"},
    Option{"--outline", 1, "polygons in a vector file, such as a basin; cells outside become no data"},
    Option{"--out", 1, "GeoTIFF to write, with FILE.tif.json beside it; both appear whole or not at all"},
    Option{"--force", 0, "replace an existing file"},
    Option{"--crs", 1, "reproject: utm, equal-area (centred on the region) or a code like EPSG:32617"},
    Option{"--cell-m", 1, "size of the cells in that projection (m) [default: the source's]"},
    Option{"--fill-voids", 0, "interpolate over voids inside tiles, up to 100 cells from their rims"},
    Option{"--yes", 0, "fetch more than 250 million cells, too"},
    Option{"--dry-run", 0, "only say which and how much would be read"},
    Option{"--offline", 0, "use the cache alone, and name what it lacks"},
    Option{"--refresh", 0, "ask the server whether cached tiles have changed"},
    Option{"--cache", 1, "folder of the cache [default: $XDG_CACHE_HOME/thalweg or ~/.cache/thalweg]"},
    Option{"--base-url", 1, "address of a mirror, instead of the source's (also THALWEG_URL_<SOURCE>)"},
    Option{"--allow-host", 1, "a further host that tiles and redirects may name"},
    Option{"--retries", 1, "attempts after the first at what may pass [default: 4]"},
    Option{"--retry-delay-s", 1, "first pause before that; it doubles each time [default: 1]"},
    Option{"--timeout-s", 1, "longest silence of a server [default: 30]"},
    Option{"--threads", 1, "connections at once, 0 for four"},
    Option{"--quiet", 0, "no progress on standard error"},
    Option{"--json", 0, "print the provenance on standard output, and nothing else there"},
};

/// What the command line holds, option by option.
struct Words {
    std::string source;
    std::array<std::vector<std::string>, options.size()> values;
    std::array<bool, options.size()> flags{};
};

void add_option(CLI::App& command, std::size_t i, Words& words) {
    const Option& option = options[i];
    if (option.values == 0) {
        command.add_flag(option.name, words.flags[i], option.text);
    } else {
        command.add_option(option.name, words.values[i], option.text)->expected(option.values)->allow_extra_args(false);
    }
}

void run(const Words& words) {
    std::vector<std::string> line{words.source};
    for (std::size_t i = 0; i < options.size(); ++i) {
        if (words.flags[i]) line.push_back(options[i].name);
        for (std::size_t j = 0; j < words.values[i].size(); ++j) {
            if (j % static_cast<std::size_t>(options[i].values) == 0) line.push_back(options[i].name);
            line.push_back(words.values[i][j]);
        }
    }
    let_signals_through();
    study::become_fetcher(line);
}

}  // namespace

void add_fetch(CLI::App& app) {
    CLI::App* command = app.add_subcommand("fetch", "Get a DEM of a region from a public source or your own tiles");
    auto words = std::make_shared<Words>();
    command
        ->add_option(
            "SOURCE", words->source,
            "copernicus-glo30, copernicus-glo90, 3dep-13, 3dep-1m, opentopography:DATASET (key in the environment "
            "variable OPENTOPOGRAPHY_API_KEY), hgt:URL or index:PATH")
        ->required();
    for (std::size_t i = 0; i < options.size(); ++i) add_option(*command, i, *words);
    command->callback([words] { run(*words); });
}

}  // namespace thalweg::tools
