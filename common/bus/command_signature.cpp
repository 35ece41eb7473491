#include "common/bus/command_signature.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <vector>

#include "common/configuration/yaml_reader.h"

namespace coach {
namespace {

constexpr size_t kSignatureBytes = 16;

std::array<uint8_t, kSignatureBytes> SignatureOf(robot_command_t command, const std::string& key) {
  std::fill(std::begin(command.hmac), std::end(command.hmac), uint8_t{0});
  std::vector<uint8_t> bytes(static_cast<size_t>(command.getEncodedSize()));
  command.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  std::array<uint8_t, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()), bytes.data(), bytes.size(), digest.data(), &length);
  std::array<uint8_t, kSignatureBytes> signature{};
  std::copy_n(digest.begin(), kSignatureBytes, signature.begin());
  return signature;
}

}  // namespace

std::string ReadKey(const std::filesystem::path& file) {
  if (file.empty()) return "";
  std::ifstream in(file, std::ios::binary);
  std::string key{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in.is_open() || key.size() < kSignatureBytes) {
    throw ConfigurationError(file.string() + ": found " +
                             (in.is_open() ? std::to_string(key.size()) + " bytes" : "no file") +
                             ", expected a key of 16 bytes or more");
  }
  return key;
}

void Sign(robot_command_t& command, const std::string& key) {
  const auto signature = SignatureOf(command, key);
  std::copy(signature.begin(), signature.end(), std::begin(command.hmac));
}

bool SignatureFits(const robot_command_t& command, const std::string& key) {
  const auto signature = SignatureOf(command, key);
  return CRYPTO_memcmp(signature.data(), &command.hmac[0], kSignatureBytes) == 0;
}

}  // namespace coach
