// Options structs from a YAML file and from `path=value` on the command line.
//
// An options struct lists its members once, `template <class V> void Visit(V& v) { v("name", name);
// ... }`; reading, overriding, printing and the refusal of unknown keys all follow from that.
#pragma once

#include <array>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace vpslam {

/// The sections that a settings file may have: one per process that has settings.
inline constexpr std::array kSettingsSections = {"frontend", "backend", "vpdetector"};

namespace settings_internal {

inline void RefuseUnknownSections(const YAML::Node& root) {
  for (const auto& entry : root) {
    const auto name = entry.first.as<std::string>();
    std::string names;
    bool known = false;
    for (const char* section : kSettingsSections) {
      known |= name == section;
      names += (names.empty() ? "" : ", ") + std::string(section);
    }
    if (!known) throw std::runtime_error(name + ": there is no such section; there are " + names);
  }
}

class Reader {
 public:
  Reader(const YAML::Node& node, std::string path) : node_(node), path_(std::move(path)) {}

  template <class T>
  void operator()(const char* name, T& value) {
    known_.insert(name);
    const YAML::Node child = node_[name];
    if (!child) return;
    if constexpr (requires(T & t, Reader & r) { t.Visit(r); }) {
      RequireMap(child, path_ + name);
      Reader reader(child, path_ + name + ".");
      value.Visit(reader);
      reader.RefuseUnknown();
    } else {
      try {
        value = child.as<T>();
      } catch (const YAML::Exception&) {
        throw std::runtime_error(path_ + name + ": '" + child.as<std::string>("?") +
                                 "' is not a value of the right kind");
      }
    }
  }

  void RefuseUnknown() const {
    for (const auto& entry : node_) {
      const auto key = entry.first.as<std::string>();
      if (known_.contains(key)) continue;
      std::string names;
      for (const std::string& name : known_) names += (names.empty() ? "" : ", ") + name;
      throw std::runtime_error(path_ + key + ": there is no such setting; there are " + names);
    }
  }

  static void RequireMap(const YAML::Node& node, const std::string& path) {
    if (!node.IsMap())
      throw std::runtime_error(path + ": must be a section with 'key: value' lines");
  }

 private:
  YAML::Node node_;
  std::string path_;
  std::set<std::string> known_;
};

class Printer {
 public:
  Printer(std::ostringstream& out, std::string prefix) : out_(out), prefix_(std::move(prefix)) {}

  template <class T>
  void operator()(const char* name, T& value) {
    if constexpr (requires(T & t, Printer & p) { t.Visit(p); }) {
      Printer nested(out_, prefix_ + name + ".");
      value.Visit(nested);
    } else {
      out_ << prefix_ << name << "=" << value << " ";
    }
  }

 private:
  std::ostringstream& out_;
  std::string prefix_;
};

}  // namespace settings_internal

/// Reads section `section` of the YAML file (none if `file` is empty), then applies `overrides`,
/// each "section.path.to.member=value"; those of other sections are passed over, but a file's
/// section must be one of kSettingsSections. Validates. Throws std::runtime_error with one line
/// naming file or override, key and fault.
template <class Options>
Options LoadSettings(const std::string& file, const std::string& section,
                     const std::vector<std::string>& overrides) {
  Options options;
  const auto apply = [&](const YAML::Node& root) {
    const YAML::Node node = root[section];
    if (!node) return;
    settings_internal::Reader::RequireMap(node, section);
    settings_internal::Reader reader(node, section + ".");
    options.Visit(reader);
    reader.RefuseUnknown();
  };
  std::string origin = file;
  try {
    if (!file.empty()) {
      const YAML::Node root = YAML::LoadFile(file);
      if (!root.IsMap()) throw std::runtime_error("holds no sections such as 'frontend:'");
      settings_internal::RefuseUnknownSections(root);
      apply(root);
    }
    for (const std::string& override_text : overrides) {
      origin = override_text;
      const size_t equals = override_text.find('=');
      if (equals == std::string::npos) throw std::runtime_error("write it as section.key=value");
      // "a.b=1" is the YAML file "{a: {b: 1}}".
      std::string yaml, closing;
      std::istringstream path(override_text.substr(0, equals));
      for (std::string key; std::getline(path, key, '.'); closing += "}") yaml += "{" + key + ": ";
      apply(YAML::Load(yaml + override_text.substr(equals + 1) + closing));
    }
  } catch (const YAML::BadFile&) {
    throw std::runtime_error(origin + ": cannot be read; name a settings file with --config");
  } catch (const YAML::Exception& e) {
    throw std::runtime_error(origin + ": is not YAML (" + e.what() + ")");
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(origin + ": " + e.what());
  }
  if (const auto why = options.Validate()) throw std::runtime_error(section + ": " + *why);
  return options;
}

/// All settings as "name=value name=value ...", for the log.
template <class Options>
std::string PrintSettings(Options options) {
  std::ostringstream out;
  settings_internal::Printer printer(out, "");
  options.Visit(printer);
  return out.str();
}

}  // namespace vpslam
