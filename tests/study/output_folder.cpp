// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/output_folder.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "support/temp_folder.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::error_of;
using test::TempFolder;

TEST_CASE("A folder appears on commit, whole, and nothing else does") {
    const TempFolder temp;
    OutputFolder folder(temp / "deep/er/out", IfPresent::refuse);
    write_text(folder.path() / "summary.json", "{}");
    CHECK_FALSE(std::filesystem::exists(temp / "deep/er/out"));
    folder.commit();
    CHECK(test::bytes_of(temp / "deep/er/out/summary.json") == "{}");
    CHECK(std::distance(std::filesystem::directory_iterator(temp / "deep/er"), {}) == 1);
}

TEST_CASE("Without a commit nothing is left, not even the parents that were made") {
    const TempFolder temp;
    {
        OutputFolder folder(temp / "deep/er/out", IfPresent::refuse);
        write_text(folder.path() / "half.txt", "half");
    }
    CHECK(temp.empty());
}

TEST_CASE("An existing folder is refused, or replaced whole when asked") {
    const TempFolder temp;
    {
        OutputFolder first(temp / "out", IfPresent::refuse);
        write_text(first.path() / "summary.json", "old");
        write_text(first.path() / "stale.txt", "old");
        first.commit();
    }
    CHECK(error_of([&] { OutputFolder(temp / "out", IfPresent::refuse); }).find("--force") != std::string::npos);
    {
        OutputFolder abandoned(temp / "out", IfPresent::replace);
        write_text(abandoned.path() / "summary.json", "new");
    }
    CHECK(test::bytes_of(temp / "out/summary.json") == "old");
    OutputFolder folder(temp / "out/", IfPresent::replace);
    write_text(folder.path() / "summary.json", "new");
    folder.commit();
    CHECK(test::bytes_of(temp / "out/summary.json") == "new");
    CHECK_FALSE(std::filesystem::exists(temp / "out/stale.txt"));
}

TEST_CASE("What is not ours is never replaced") {
    const TempFolder temp;
    std::filesystem::create_directory(temp / "thesis");
    std::ofstream(temp / "thesis/chapter1.txt") << "years of work";
    std::ofstream(temp / "thesis/manifest.json") << "{}";
    CHECK(test::is_sentence(error_of([&] { OutputFolder(temp / "thesis", IfPresent::replace); })));
    temp.text("file", "content");
    CHECK(test::is_sentence(error_of([&] { OutputFolder(temp / "file", IfPresent::replace); })));
    CHECK(test::is_sentence(error_of([&] { OutputFolder(temp / "file/below", IfPresent::refuse); })));
    CHECK(test::bytes_of(temp / "thesis/chapter1.txt") == "years of work");
    CHECK(test::bytes_of(temp / "file") == "content");
}

TEST_CASE("A file that a user put beside our results keeps them from being replaced") {
    const TempFolder temp;
    OutputFolder folder(temp / "out", IfPresent::refuse);
    std::filesystem::create_directory(folder.path() / "figures");
    write_text(folder.path() / "figures/map.png", "ours");
    folder.commit();
    CHECK(error_of([&] { OutputFolder(temp / "out", IfPresent::replace); }) == "");
    std::ofstream(temp / "out/figures/notes.txt") << "mine";
    CHECK(error_of([&] { OutputFolder(temp / "out", IfPresent::replace); }).find("notes.txt") != std::string::npos);
    CHECK(test::bytes_of(temp / "out/figures/notes.txt") == "mine");
}

TEST_CASE("What came to stand there while we worked is not replaced either") {
    const TempFolder temp;
    OutputFolder folder(temp / "out", IfPresent::refuse);
    write_text(folder.path() / "summary.json", "ours");
    std::filesystem::create_directory(temp / "out");
    std::ofstream(temp / "out/notes.txt") << "mine";
    CHECK(error_of([&] { folder.commit(); }).find("exists already") != std::string::npos);
    CHECK(test::bytes_of(temp / "out/notes.txt") == "mine");

    OutputFolder(temp / "more", IfPresent::refuse).commit();
    OutputFolder second(temp / "more", IfPresent::replace);
    std::ofstream(temp / "more/notes.txt") << "mine";
    CHECK(error_of([&] { second.commit(); }).find("notes.txt") != std::string::npos);
    CHECK(test::bytes_of(temp / "more/notes.txt") == "mine");
}

TEST_CASE("A link to a folder that a user put beside our results keeps them from being replaced") {
    const TempFolder temp;
    OutputFolder(temp / "out", IfPresent::refuse).commit();
    std::filesystem::create_directory_symlink(temp / ".", temp / "out/elsewhere");
    CHECK(error_of([&] { OutputFolder(temp / "out", IfPresent::replace); }).find("elsewhere") != std::string::npos);
}

TEST_CASE("What killed runs left of the same folder is removed, and nothing of a living one or of another") {
    const TempFolder temp;
    const pid_t gone = ::fork();
    if (gone == 0) ::_exit(0);
    ::waitpid(gone, nullptr, 0);
    const auto of = [&](const std::string& folder, pid_t process) {
        return temp / ("." + folder + ".partial-" + std::to_string(process));
    };
    std::filesystem::create_directory(of("out", ::getppid()));
    std::filesystem::create_directories(of("out", gone) / "figures");
    std::ofstream(of("out", gone) / "figures/map.png") << "half";
    std::filesystem::create_directory(of("other", gone));
    std::filesystem::create_directory(temp / ".out.partial-");
    std::filesystem::create_directory(temp / (".out.partial-" + std::to_string(gone) + "x"));
    std::filesystem::create_directory(temp / "kept");
    std::filesystem::create_directory_symlink(temp / "kept", of("out", 2147483646));
    OutputFolder living(temp / "out", IfPresent::refuse);
    CHECK(remove_abandoned(temp / "out/") == std::vector{of("out", gone).filename().string()});
    CHECK_FALSE(std::filesystem::exists(of("out", gone)));
    CHECK(std::filesystem::is_directory(living.path()));
    CHECK(std::distance(std::filesystem::directory_iterator(temp / "."), {}) == 7);
    CHECK(remove_abandoned(temp / "out").empty());
}

TEST_CASE("A folder locked by a process whose number this machine does not know is left alone") {
    const TempFolder temp;
    const pid_t gone = ::fork();
    if (gone == 0) ::_exit(0);
    ::waitpid(gone, nullptr, 0);
    const std::filesystem::path mine = [&] {
        OutputFolder folder(temp / "out", IfPresent::refuse);
        const auto elsewhere = temp / (".out.partial-" + std::to_string(gone));
        std::filesystem::rename(folder.path(), elsewhere);  // as if its process lived on another machine
        CHECK(remove_abandoned(temp / "out").empty());
        CHECK(std::filesystem::exists(elsewhere));
        return elsewhere;
    }();
    CHECK(remove_abandoned(temp / "out").size() == 1);  // it has ended, and its lock with it
    CHECK_FALSE(std::filesystem::exists(mine));
}

TEST_CASE("What a killed run of this process' own number left does not get into the results") {
    const TempFolder temp;
    const auto left = temp / (".out.partial-" + std::to_string(::getpid()));
    std::filesystem::create_directory(left);
    std::ofstream(left / "stale.txt") << "old";
    OutputFolder folder(temp / "out", IfPresent::refuse);
    CHECK(error_of([&] { OutputFolder(temp / "out", IfPresent::refuse); }).find("is writing") != std::string::npos);
    write_text(folder.path() / "summary.json", "new");
    folder.commit();
    CHECK_FALSE(std::filesystem::exists(temp / "out/stale.txt"));
    CHECK(test::bytes_of(temp / "out/summary.json") == "new");
}

TEST_CASE("Text that cannot be written whole is an error") {
    CHECK(test::is_sentence(error_of([] { write_text("/dev/full", std::string(100000, 'x')); })));
}

TEST_CASE("A folder that cannot be made or replaced is refused in our words before anything is written") {
    for (const char* root : {"/", "//", "/..", "/tmp/.."}) {
        CHECK_THAT(error_of([&] { OutputFolder(root, IfPresent::replace); }), Catch::Matchers::Contains("root"));
    }
    const TempFolder temp;
    const std::string endless = error_of([&] { OutputFolder(temp / std::string(300, 'x'), IfPresent::refuse); });
    CHECK(test::is_sentence(endless));
    CHECK_THAT(endless, Catch::Matchers::Contains("cannot write into"));
    CHECK_THAT(error_of([&] { OutputFolder(temp / std::string(300, 'x') / "out", IfPresent::refuse); }),
               Catch::Matchers::Contains("cannot write into"));
    CHECK(temp.empty());
}
