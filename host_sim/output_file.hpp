// A result file that is there complete, or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace host_sim {

/// Collects what is written in a hidden temporary file beside the final name and renames it on commit().
///
/// Without commit() – an exception, SIGINT, SIGTERM, SIGHUP – the temporary file is removed and what stood under the
/// final name stays. A name that is no regular file (/dev/stdout, a pipe) cannot be renamed to: it is written in place.
/// A symbolic link stays a link: the file it names is replaced. All failures are OutputErrors.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);
  void commit();  ///< Everything on the disk, then under the final name. Once.

  /// For a library that opens files by name: what it writes there is committed like the rest. It is the final name
  /// itself when that is written in place.
  [[nodiscard]] const std::string& temporary() const { return temporary_; }

 private:
  void flush();
  void discard() noexcept;

  std::string name_;       // as the user gave it, for messages
  std::string final_;      // where it goes, links followed
  std::string temporary_;  // where it is until then
  bool in_place_ = false;
  int descriptor_ = -1;
  std::size_t slot_ = 0;  // in the table of files that a signal removes
  std::string buffer_;
};

/// Writes the whole file, or throws an OutputError.
void write_file(const std::filesystem::path& file, std::string_view bytes);

/// Removes the temporary files of all OutputFiles not yet committed; safe in a signal handler. The first OutputFile
/// installs handlers that do this for SIGINT, SIGTERM and SIGHUP where the program has none of its own.
void remove_unfinished_files() noexcept;

}  // namespace host_sim
