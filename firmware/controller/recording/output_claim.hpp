// Files that a run writes: none that it reads, none that somebody else writes, none of yesterday without a word.
#pragma once

#include <string>
#include <vector>

#include "firmware/controller/devices/options.hpp"
#include "firmware/description/rig_description.hpp"

namespace firmware::controller {

/// Every file that a run reads: description, its tables, road, programme with its roads, recording to replay.
[[nodiscard]] std::vector<std::string> files_read(const Options& options, const RigDescription& rig);

/// True: the name leads to one of these files, by device and inode. A name that leads nowhere does not.
[[nodiscard]] bool leads_to_one_of(const std::string& file, const std::vector<std::string>& others);

/// An output that is to be replaced at the end of a run (--histogram). What is wrong, in one line; empty: nothing. A
/// name that exists needs `overwrite`; a file that the run reads and a link are refused.
[[nodiscard]] std::string output_objection(const std::string& file, bool overwrite,
                                           const std::vector<std::string>& inputs);

/// A file that is written while the run lasts.
struct ClaimedFile {
  int descriptor = -1;  ///< opened and locked for this program (flock)
  int error = 0;        ///< else errno: EEXIST it exists, ELOOP it is a link, EWOULDBLOCK another program writes it,
                        ///< ETXTBSY the run reads it, ENXIO nobody reads the pipe, …
};

/// Opens a file to write it. One that exists is taken only with `overwrite`, and emptied only once it is locked. Links
/// are not followed, except below /dev and /proc, and to what is no file (a pipe, /dev/null); that is not locked.
[[nodiscard]] ClaimedFile claim_file(const std::string& file, bool overwrite, const std::vector<std::string>& inputs);

/// The fault of an output in words, by its errno.
[[nodiscard]] std::string claim_trouble(const std::string& file, int error);

/// True: a recording of that name may give it to one of its parts (run-0002.csv of run.csv).
[[nodiscard]] bool is_name_of_part(const std::string& name, const std::string& file);

/// Parts of an earlier recording of that name which exist: run-0002.csv for run.csv.
[[nodiscard]] std::vector<std::string> present_parts(const std::string& file);

}  // namespace firmware::controller
