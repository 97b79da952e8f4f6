// Memory in files: it holds what was written, and a large file's contents are those of the file.
#include "host_sim/recording_files/mapped_memory.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace mapped_memory_test {
namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20U;

// Law. Pages that were given back to the kernel come back as they were: MADV_DONTNEED is what the thread does.
TEST(MappedMemory, ABlockKeepsItsContentsWhenItsPagesAreGivenBack) {
  host_sim::keep_large_blocks_in_files();
  if (!host_sim::large_blocks_are_in_files()) GTEST_SKIP() << "no folder on a disk for temporary files";
  void* const block = host_sim::take_file_block(3 * mebibyte + 5);
  if (block == nullptr) GTEST_SKIP() << "no room for a temporary file";
  auto* const bytes = static_cast<unsigned char*>(block);
  for (std::size_t i = 0; i < 3 * mebibyte + 5; i += 1000) bytes[i] = static_cast<unsigned char>(i / 1000);
  ASSERT_EQ(::madvise(block, 3 * mebibyte, MADV_DONTNEED), 0);
  for (std::size_t i = 0; i < 3 * mebibyte + 5; i += 1000)
    ASSERT_EQ(bytes[i], static_cast<unsigned char>(i / 1000)) << i;
  EXPECT_TRUE(host_sim::release_file_block(block));
}

TEST(MappedMemory, ABlockOfTheHeapIsNoneOfIts) {
  const std::string text(100, 'x');
  EXPECT_FALSE(host_sim::release_file_block(const_cast<char*>(text.data())));
}

TEST(MappedMemory, ContentsAreThoseOfTheFileOrOfTheStream) {
  const support::TemporaryFolder folder;
  for (const std::size_t size : {std::size_t{0}, std::size_t{5000}, 17 * mebibyte}) {
    std::string written(size, 'a');
    for (std::size_t i = 0; i < size; i += 997) written[i] = static_cast<char>('a' + i % 26);
    const int file = ::open(folder.write("file", written).c_str(), O_RDONLY);
    std::string head(1024, '\0');
    head.resize(static_cast<std::size_t>(::read(file, head.data(), head.size())));
    EXPECT_TRUE(host_sim::FileContents(file, head, "file").bytes() == written) << size;
    ::close(file);
  }
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  ASSERT_EQ(::write(ends[1], "defg", 4), 4);
  ::close(ends[1]);
  EXPECT_EQ(host_sim::FileContents(ends[0], "abc", "-").bytes(), "abcdefg");
  ::close(ends[0]);
}

}  // namespace
}  // namespace mapped_memory_test
