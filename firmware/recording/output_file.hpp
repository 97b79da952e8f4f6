// Result files that appear complete or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace firmware {

/// Writes to a hidden temporary file beside the final name and renames it on commit().
///
/// "-" is standard output. Without commit() (exception, SIGINT, SIGTERM, SIGHUP) the temporary file is removed and an existing file under the
/// final name stays. A name that is not a regular file (/dev/stdout, a pipe) is written in place.
/// A symbolic link stays a link: the file it names is replaced. All failures are OutputErrors.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);
  void commit();  ///< Flushes to the disk, then renames. Call once.

  /// For a library that opens files by name: the file it writes here is committed. Equals the final name for a file
  /// that is written in place.
  [[nodiscard]] const std::string& temporary() const { return temporary_; }

 private:
  void flush();
  void discard() noexcept;

  std::string name_;       // as given by the user, for messages
  std::string final_;      // target, symbolic links resolved
  std::string temporary_;  // name until commit()
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

}  // namespace firmware
