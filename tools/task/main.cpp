// coach-task: makes new tasks, checks tasks, draws their picture books.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>

#include "common/assembly/task_file.h"
#include "common/bus/messages.h"
#include "common/bus/node.h"
#include "common/bus/process_facts.h"
#include "common/configuration/station.h"
#include "tools/task/learned_poses.h"
#include "tools/task/picture_book.h"
#include "tools/task/task_draft.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string name, folder = ".", units = "mm", task, output, station_file, url;
  std::vector<std::string> parts, models;
  bool replace = false;
};

/// "long=blue:brick.stl:2": name, colour, file and count of a part type.
DraftType PartOf(const std::string& text, double unit) {
  const size_t equals = text.find('='), colon = text.find(':', equals), second = text.rfind(':');
  if (equals == std::string::npos || colon == std::string::npos)
    throw ConfigurationError("--part: found '" + text + "', expected NAME=COLOUR:FILE or NAME=COLOUR:FILE:COUNT");
  const bool counted = second != colon && text.find_first_not_of("0123456789", second + 1) == std::string::npos;
  const std::string file = text.substr(colon + 1, counted ? second - colon - 1 : std::string::npos);
  DraftType type = MakeType(text.substr(0, equals), text.substr(equals + 1, colon - equals - 1), ReadWhole(file, unit));
  if (counted) type.count = std::max(1, std::atoi(text.c_str() + second + 1));
  return type;
}

void Report(const TaskDraft& draft, const DraftOptions& options, const fs::path& file) {
  const Contacts contacts = FindContacts(draft, options);
  for (const auto& type : draft.types)
    std::printf("%3d x %-20s %-8s %zu triangles%s\n", type.count, type.name.c_str(), type.colour.c_str(),
                type.mesh.triangles.size(), type.symmetries.trivial() ? "" : ", symmetric");
  std::printf("%zu connections, %zu of them close by themselves\n", contacts.joining.size() + contacts.closing.size(),
              contacts.closing.size());
  for (const auto& doubt : Doubts(draft, options)) std::printf("look at this: %s\n", Sentence(doubt).c_str());
  std::printf("%s\n", file.c_str());
}

int New(const Arguments& arguments) {
  const double unit = arguments.units == "m" ? 1 : 0.001;
  std::vector<DraftType> types;
  for (const auto& part : arguments.parts) types.push_back(PartOf(part, unit));
  TaskDraft draft{arguments.name, types, {}};
  if (!arguments.models.empty()) {
    std::vector<MeshPiece> pieces;
    for (const auto& model : arguments.models) {
      auto read = ReadPieces(model, unit);
      if (read.size() == 1 && arguments.models.size() == 1) read = Connected(read[0]);
      pieces.insert(pieces.end(), read.begin(), read.end());
    }
    draft = DraftOfModel(arguments.name, pieces, types);
  }
  Report(draft, {}, SaveTask(draft, arguments.folder, arguments.replace));
  return 0;
}

int Learn(const Arguments& arguments) {
  constexpr int64_t kPatience = 60'000'000;  // us
  const Station station = arguments.station_file.empty() ? DefaultStation() : ReadStation(arguments.station_file);
  const Task task = LoadTask(arguments.task.empty() ? station.task : fs::path(arguments.task));
  NodeOptions options;
  options.service = "task";
  options.station = station.name;
  options.url = arguments.url.empty() ? station.table_url : arguments.url;
  Node node(options);
  LearnedPoses poses;
  std::optional<LearnedPoses::Result> result;
  int64_t first = 0;
  node.SubscribeNewest<part_poses_t>([&](const part_poses_t& m) {
    first = first ? first : m.utime;
    poses.Add(FromMessage(m));
    if (m.utime - first < poses.options().window_us) return;
    result = poses.Mean(task);
    if (result->problems.empty()) node.Stop();
  });
  std::fprintf(stderr, "Leave the finished structure on the table and take the hands away ...\n");
  const int64_t begun = SteadyTime();
  node.Run([&] {
    if (SteadyTime() - begun > kPatience) node.Stop();
  });
  if (!result) throw std::runtime_error("no tracker answers");
  if (!result->problems.empty()) throw std::runtime_error(Sentence(result->problems[0]));
  const DraftOptions draft_options{.touching = poses.options().touching};
  const TaskDraft draft = DraftOfTable(arguments.name, task, result->X_TP);
  Report(draft, draft_options, SaveTask(draft, arguments.folder, arguments.replace, draft_options));
  return 0;
}

int Check(const Arguments& arguments) {
  const Task task = LoadTask(arguments.task);
  std::printf("%s: %zu part types, %zu parts, %zu connections, %zu steps\n", task.name.c_str(), task.types.size(),
              task.parts.size(), task.connections.size(), task.steps.size());
  return 0;
}

void Write(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.flush();
  if (!out) throw std::runtime_error(file.string() + ": can't be written");
}

int Book(const Arguments& arguments) {
  const Task task = LoadTask(arguments.task);
  const auto pages = PictureBook(task);
  fs::create_directories(arguments.output);
  for (const auto& page : pages) Write(fs::path(arguments.output) / (page.name + ".svg"), page.svg);
  Write(fs::path(arguments.output) / "book.html", BookHtml(task, pages));
  std::printf("%zu pages in %s; print book.html for paper or PDF\n", pages.size(), arguments.output.c_str());
  return 0;
}

int Main(int argc, char** argv) {
  Arguments a;
  CLI::App app("New tasks from meshes or from a structure on the table; checks; picture books.", "coach-task");
  app.require_subcommand(1);
  CLI::App* make = app.add_subcommand("new", "makes a task from meshes (OBJ, STL, PLY, GLB)");
  make->add_option("NAME", a.name, "of the task")->required();
  make->add_option("--part", a.parts, "NAME=COLOUR:FILE[:COUNT]; one for each kind of part");
  make->add_option("--model", a.models,
                   "finished model: files with the parts where they are in the end; what touches is connected");
  make->add_option("--units", a.units, "of the meshes: mm or m (a GLB is in metres)")
      ->check(CLI::IsMember({"mm", "m"}));
  CLI::App* learn = app.add_subcommand("learn", "makes a task from a structure that was built on the table");
  learn->add_option("NAME", a.name, "of the new task")->required();
  learn->add_option("--config", a.station_file, "station file");
  learn->add_option("--task", a.task, "task whose parts are on the table (default: the station's)");
  learn->add_option("--lcm-url", a.url, "network instead of the station file's");
  for (CLI::App* one : {make, learn}) {
    one->add_option("--folder", a.folder, "folder for the new task");
    one->add_flag("--replace", a.replace, "replace a task of this name");
  }
  CLI::App* check = app.add_subcommand("check", "reads a task as the services do");
  CLI::App* book = app.add_subcommand("book", "draws the steps for children: SVG pages and a page to print");
  for (CLI::App* one : {check, book}) one->add_option("TASK", a.task, "task file")->required();
  book->add_option("FOLDER", a.output, "for the pages")->required();
  CLI11_PARSE(app, argc, argv);
  if (make->parsed()) return New(a);
  if (learn->parsed()) return Learn(a);
  return check->parsed() ? Check(a) : Book(a);
}

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  try {
    return coach::Main(argc, argv);
  } catch (const coach::ConfigurationError& e) {
    std::fprintf(stderr, "coach-task: %s\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "coach-task: %s\n", e.what());
    return 1;
  }
}
