// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thalweg::study {

enum class IfPresent { refuse, replace };

/// The absolute place of a folder of results. Throws Error for no path and for the root of all folders.
std::filesystem::path output_place(const std::filesystem::path& given);

/// A folder that appears whole or not at all: files are written into a hidden neighbour, which takes the final name in
/// one rename on `commit`. Without a commit nothing is left behind, and what stood there before is still there. A
/// folder that holds a file or a link that we did not write (as its list, .thalweg-files, tells) is never replaced.
///
/// While it lives it holds a lock (flock) on the hidden folder, by which others can tell it from one that was left by a
/// run that was killed.
class OutputFolder {
  public:
    /// Throws Error if `final` exists and may not be replaced (also for lack of the rights to delete it), its parent
    /// cannot be written, or another process with this one's number (in another container, or on another machine) is
    /// writing the same folder.
    OutputFolder(std::filesystem::path final, IfPresent);
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    /// Where to write for now.
    const std::filesystem::path& path() const { return partial_; }
    /// Throws Error if what meanwhile came to stand at `final` may not be replaced.
    void commit();

    /// Removes what was written so far, as the destructor does without a commit; for a program that is being stopped.
    void discard();

  private:
    void check() const;
    void make_partial();

    std::filesystem::path given_, final_;
    IfPresent if_present_;
    std::filesystem::path partial_;
    std::vector<std::filesystem::path> created_parents_;  ///< innermost first
    int lock_ = -1;                                       ///< file descriptor of the hidden folder
    bool committed_ = false;
};

/// Removes the hidden folders that runs into `final` left when they were killed, and nothing of a process that lives:
/// only what nobody holds locked and is named after a process that this machine does not have. Returns their names.
std::vector<std::string> remove_abandoned(const std::filesystem::path& final);

/// Writes a text file whole; throws Error if the disk is full or it cannot be written.
void write_text(const std::filesystem::path&, const std::string&);

/// Contents of a text file; throws Error if it cannot be read.
std::string read_text(const std::filesystem::path&);

}  // namespace thalweg::study
