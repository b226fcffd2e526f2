// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

namespace thalweg {

/// Something the user can mend: a file, a parameter, a size. One sentence that says what was found, what was needed and
/// where. The command line prints it after `thalweg: error: ` and exits with 2.
class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A remote server that failed where the user did nothing wrong. The command line exits with 3.
class RemoteError : public Error {
  public:
    using Error::Error;
};

}  // namespace thalweg
