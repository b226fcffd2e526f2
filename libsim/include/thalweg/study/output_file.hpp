// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "thalweg/study/output_folder.hpp"

namespace thalweg::study {

/// A file that appears whole or not at all: written under a hidden name beside its place, which it then takes in one
/// step. Without that nothing is left behind, and what stood there before is still there.
class OutputFile {
  public:
    /// Throws Error, before any long work, if something exists there that may not be replaced, or there is no folder
    /// that can be written into.
    OutputFile(std::filesystem::path, IfPresent);
    ~OutputFile() { discard(); }
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Throws Error as above, or if the disk is full.
    void write(const std::string& contents);

    /// Removes what has not taken its place; for a program that is being stopped.
    void discard() const;

  private:
    void check() const;
    std::filesystem::path path_, partial_;
    IfPresent if_present_;
};

}  // namespace thalweg::study
