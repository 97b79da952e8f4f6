#include "firmware/controller/recording/output_claim.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "firmware/description/programme.hpp"

namespace firmware::controller {
namespace {

namespace fs = std::filesystem;

bool same_file(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

/// Without following a link: what a new file would have to replace.
enum class Present { nothing, file, link, other };
Present present(const std::string& file) {
  struct stat there {};
  if (::lstat(file.c_str(), &there) != 0) return Present::nothing;
  if (!S_ISLNK(there.st_mode)) return S_ISREG(there.st_mode) ? Present::file : Present::other;
  // /dev/stdout is a link to whatever the shell has opened; a link to a pipe or a device replaces nothing.
  if (file.starts_with("/dev/") || file.starts_with("/proc/")) return Present::other;
  const bool followed = ::stat(file.c_str(), &there) == 0;
  return followed && !S_ISREG(there.st_mode) && !S_ISDIR(there.st_mode) ? Present::other : Present::link;
}

ClaimedFile failed(int descriptor, int error) {
  if (descriptor >= 0) ::close(descriptor);
  return {-1, error};
}

bool is_road_file(const std::string& road) { return !road.empty() && !road.starts_with("iso8608:"); }

}  // namespace

std::vector<std::string> files_read(const Options& options, const RigDescription& rig) {
  std::vector<std::string> files{rig.source};
  for (const fs::path& table : referenced_files(rig)) files.push_back(table.string());
  if (!options.replay.empty()) files.push_back(options.replay);
  if (options.programme.empty()) {
    if (is_road_file(options.road)) files.push_back(options.road);
    return files;
  }
  files.push_back(options.programme);
  for (const ProgrammeBlock& block : read_programme(options.programme).blocks) {
    if (is_road_file(block.road)) files.push_back(block.road);
  }
  return files;
}

bool leads_to_one_of(const std::string& file, const std::vector<std::string>& others) {
  struct stat own {};
  if (::stat(file.c_str(), &own) != 0) return false;
  return std::any_of(others.begin(), others.end(), [&](const std::string& other) {
    struct stat there {};
    return ::stat(other.c_str(), &there) == 0 && same_file(own, there);
  });
}

std::string output_objection(const std::string& file, bool overwrite, const std::vector<std::string>& inputs) {
  if (leads_to_one_of(file, inputs)) return claim_trouble(file, ETXTBSY);
  const Present there = present(file);
  if (there == Present::link) return claim_trouble(file, ELOOP);
  if (there == Present::file && !overwrite) return claim_trouble(file, EEXIST);
  return {};
}

ClaimedFile claim_file(const std::string& file, bool overwrite, const std::vector<std::string>& inputs) {
  if (leads_to_one_of(file, inputs)) return {-1, ETXTBSY};
  const Present there = present(file);
  if (there == Present::link) return {-1, ELOOP};
  if (there == Present::file && !overwrite) return {-1, EEXIST};
  int flags = O_WRONLY | O_CLOEXEC | O_NOCTTY;
  // Nobody may read a pipe: that is refused, not waited for.
  flags |= there == Present::other ? O_NONBLOCK : O_NOFOLLOW;
  if (there == Present::nothing) flags |= O_CREAT | O_EXCL;
  const int descriptor = ::open(file.c_str(), flags, 0666);
  if (descriptor < 0) return {-1, errno};
  struct stat opened {};
  if (::fstat(descriptor, &opened) != 0 || !S_ISREG(opened.st_mode)) {
    const bool waits = ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) & ~O_NONBLOCK) == 0;
    return waits ? ClaimedFile{descriptor, 0} : failed(descriptor, errno);
  }
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) return failed(descriptor, EWOULDBLOCK);
  // A file that this run reads may have come under this name meanwhile.
  if (there == Present::file && leads_to_one_of(file, inputs)) return failed(descriptor, ETXTBSY);
  if (there == Present::file && ::ftruncate(descriptor, 0) != 0) return failed(descriptor, errno);
  return {descriptor, 0};
}

std::string claim_trouble(const std::string& file, int error) {
  switch (error) {
    case EEXIST:
      return file + ": File exists, expected a new name or --overwrite";
    case ELOOP:
      return file + ": is a link, expected the name of the file itself";
    case EWOULDBLOCK:
      return file + ": another program writes it, expected another name";
    case ENXIO:
      return file + ": is a pipe that nobody reads, expected a reader before the run";
    case ETXTBSY:
      return file + ": is read by this run, expected another name for what it writes";
    default:
      return file + ": " + std::strerror(error) + ", expected a file that can be written";
  }
}

bool is_name_of_part(const std::string& name, const std::string& file) {
  const fs::path whole(file), part(name);
  const auto folder = [](const fs::path& path) {
    return path.parent_path().empty() ? fs::path(".") : path.parent_path();
  };
  std::error_code error;
  if (!fs::equivalent(folder(part), folder(whole), error)) return false;
  const std::string stem = whole.stem().string() + "-", extension = whole.extension().string();
  const std::string last = part.filename().string();
  if (last.size() < stem.size() + 4 + extension.size() || !last.starts_with(stem) || !last.ends_with(extension)) {
    return false;
  }
  const std::string number = last.substr(stem.size(), last.size() - stem.size() - extension.size());
  return std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::vector<std::string> present_parts(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  std::vector<std::string> parts;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, error)) {
    const std::string name = (folder / entry.path().filename()).string();
    if (is_name_of_part(name, file)) parts.push_back(name);
  }
  std::sort(parts.begin(), parts.end());
  return parts;
}

}  // namespace firmware::controller
