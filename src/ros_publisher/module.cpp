// robotteamsim._ros_publisher: roscpp's publishers for Python, for messages that are bytes already.
//
// rospy has a thread per subscriber, and accepts so few connections at a time that a client of 30 robots needs minutes
// to connect to all their topics (bench/results/ros.csv).
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <ros/ros.h>

#include <cstdint>
#include <cstring>
#include <string>

namespace nb = nanobind;

namespace {

// A message as it is sent.
struct Bytes {
  const char* data;
  std::size_t size;
};

}  // namespace

namespace ros {
namespace message_traits {

// roscpp compares these with those of the topic; "*" is any.
template <>
struct MD5Sum<Bytes> {
  static const char* value() { return "*"; }
  static const char* value(const Bytes&) { return "*"; }
};
template <>
struct DataType<Bytes> {
  static const char* value() { return "*"; }
  static const char* value(const Bytes&) { return "*"; }
};

}  // namespace message_traits
namespace serialization {

template <>
struct Serializer<Bytes> {
  static void write(OStream& stream, const Bytes& message) {
    std::memcpy(stream.advance(static_cast<std::uint32_t>(message.size)), message.data, message.size);
  }
  static std::uint32_t serializedLength(const Bytes& message) { return static_cast<std::uint32_t>(message.size); }
};

}  // namespace serialization
}  // namespace ros

namespace {

void Start(const std::string& name, const std::string& ns) {
  ros::init(ros::M_string{{"__ns", ns}}, name, ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
  ros::start();
}

ros::Publisher Advertise(const std::string& topic, const std::string& type, const std::string& md5sum,
                         const std::string& definition, bool has_header, bool latched) {
  constexpr int kUnlimited = 0;
  ros::AdvertiseOptions options(topic, kUnlimited, md5sum, type, definition);
  options.has_header = has_header;
  options.latch = latched;
  return ros::NodeHandle().advertise(options);
}

}  // namespace

NB_MODULE(_ros_publisher, module) {
  module.def("start", &Start, nb::arg("name"), nb::arg("namespace"), "Start a node of roscpp in this process.");
  module.def("shut_down", &ros::shutdown, "End it.", nb::call_guard<nb::gil_scoped_release>());
  nb::class_<ros::Publisher>(module, "Publisher", "A topic without a limit of messages that wait to be sent.")
      .def(
          "__init__",
          [](ros::Publisher* self, const std::string& topic, const std::string& type, const std::string& md5sum,
             const std::string& definition, bool has_header, bool latched) {
            new (self) ros::Publisher(Advertise(topic, type, md5sum, definition, has_header, latched));
          },
          nb::arg("topic"), nb::arg("type"), nb::arg("md5sum"), nb::arg("definition"), nb::kw_only(),
          nb::arg("has_header"), nb::arg("latched"), "Advertise.")
      .def(
          "publish",
          [](const ros::Publisher& publisher, nb::bytes data) { publisher.publish(Bytes{data.c_str(), data.size()}); },
          nb::arg("data"), "Publish a serialized message; of one with a header, roscpp writes its number.")
      .def_prop_ro("num_subscribers", &ros::Publisher::getNumSubscribers);
}
