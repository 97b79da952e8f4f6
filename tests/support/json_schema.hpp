// The JSON that a command writes against its schema in host_sim/schemas (JSON Schema 2020-12): a key that a script may
// rely on is in the schema, and every key of the schema's "required" is in the JSON.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace support {

/// Whether `value` is what the word of a schema says: "object", "array", "string", "number", "integer", "boolean", "null".
inline bool is_of_type(const nlohmann::json& value, const std::string& type) {
  if (type == "number") return value.is_number();
  if (type == "integer") return value.is_number_integer();
  return type == value.type_name();
}

/// The keywords that our schemas use: type, enum, properties, required, additionalProperties, items, $ref to "#/…".
/// "" or what is wrong first, with its place.
inline std::string schema_error(const nlohmann::json& value, const nlohmann::json& schema, const nlohmann::json& root,
                                const std::string& at = "$") {
  if (schema.is_boolean()) return schema.get<bool>() ? "" : at + ": no such key in the schema";
  if (schema.contains("$ref")) {
    const nlohmann::json::json_pointer target(schema["$ref"].get<std::string>().substr(1));
    return schema_error(value, root.at(target), root, at);
  }
  if (schema.contains("type")) {
    const nlohmann::json types = schema["type"].is_array() ? schema["type"] : nlohmann::json::array({schema["type"]});
    if (std::none_of(types.begin(), types.end(), [&](const auto& type) { return is_of_type(value, type); })) {
      return at + ": is " + value.type_name() + ", expected " + types.dump();
    }
  }
  if (schema.contains("enum") && std::ranges::find(schema["enum"], value) == schema["enum"].end()) {
    return at + ": is " + value.dump() + ", expected one of " + schema["enum"].dump();
  }
  if (value.is_object()) {
    for (const auto& key : schema.value("required", nlohmann::json::array())) {
      if (!value.contains(key)) return at + ": lacks " + key.dump();
    }
    const nlohmann::json properties = schema.value("properties", nlohmann::json::object());
    const nlohmann::json others = schema.value("additionalProperties", nlohmann::json(true));
    for (const auto& [key, inner] : value.items()) {
      const std::string wrong =
          schema_error(inner, properties.contains(key) ? properties[key] : others, root, at + "." + key);
      if (!wrong.empty()) return wrong;
    }
  }
  if (value.is_array() && schema.contains("items")) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::string wrong = schema_error(value[i], schema["items"], root, at + "[" + std::to_string(i) + "]");
      if (!wrong.empty()) return wrong;
    }
  }
  return "";
}

/// Two commands may write the same result: without what says by which command line it came.
inline nlohmann::json without_origin(nlohmann::json result) {
  result.erase("command");
  result.erase("inputs");
  return result;
}

/// Fails the test unless `text` is JSON that agrees with the schema it names: "rigtwin/NAME/1" is NAME.json.
inline void expect_schema(const std::string& text) {
  const nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
  ASSERT_TRUE(value.is_object() && value.contains("schema")) << text.substr(0, 200);
  const std::string id = value["schema"];
  ASSERT_TRUE(id.starts_with("rigtwin/") && id.ends_with("/1")) << id;
  const auto file =
      std::filesystem::path(RIGTWIN_SOURCE_DIR) / "host_sim/schemas" / (id.substr(8, id.size() - 10) + ".json");
  ASSERT_TRUE(std::filesystem::exists(file)) << file;
  const nlohmann::json schema = nlohmann::json::parse(TemporaryFolder::read(file));
  EXPECT_EQ(schema_error(value, schema, schema), "") << file;
}

}  // namespace support
