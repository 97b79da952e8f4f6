#include "firmware/description/text/sha256.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace {

using firmware::sha256;

// The examples of FIPS 180-4, and lengths around a block of 64 bytes against sha256sum.
TEST(Sha256, AgreesWithTheStandard) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_EQ(sha256(std::string(55, 'x')), "d5e285683cd4efc02d021a5c62014694958901005d6f71e89e0989fac77e4072");
  EXPECT_EQ(sha256(std::string(64, 'x')), "7ce100971f64e7001e8fe5a51973ecdfe1ced42befe7ee8d5fd6219506b5393c");
}

// However the text is cut into pieces: none, a byte, ends of blocks, more than a block.
TEST(Sha256, TakesPieces) {
  const std::string text(1000, 'x');
  firmware::Sha256 hash;
  std::size_t at = 0;
  for (const std::size_t piece : {0U, 1U, 63U, 64U, 100U, 28U, 500U, 244U}) {
    hash.take(std::string_view(text).substr(at, piece));
    at += piece;
  }
  ASSERT_EQ(at, text.size());
  EXPECT_EQ(hash.digits(), sha256(text));
}

}  // namespace
