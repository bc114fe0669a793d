// A message of any type as its serialized bytes, for publishers, subscribers and services of roscpp.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace robotteamsim::ros_transport {

struct RawMessage {
  std::string bytes;
};

// The type of a topic, as in a connection header.
struct MessageType {
  std::string name;  // such as "nav_msgs/Odometry"
  std::string md5sum;
  std::string definition;
  bool has_header;  // the message begins with a std_msgs/Header
};

// Returns the bytes of a message of a generated type.
template <class Message>
RawMessage Serialized(const Message& message) {
  RawMessage raw;
  raw.bytes.resize(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(raw.bytes.data()),
                                     static_cast<std::uint32_t>(raw.bytes.size()));
  ros::serialization::serialize(stream, message);
  return raw;
}

// Throws std::invalid_argument: the bytes are too few.
template <class Message>
Message Deserialized(std::string_view bytes) {
  Message message;
  // roscpp's IStream requires a mutable pointer, but only reads.
  ros::serialization::IStream stream(reinterpret_cast<std::uint8_t*>(const_cast<char*>(bytes.data())),
                                     static_cast<std::uint32_t>(bytes.size()));
  try {
    ros::serialization::deserialize(stream, message);
  } catch (const ros::serialization::StreamOverrunException&) {
    throw std::invalid_argument(std::string(ros::message_traits::datatype<Message>()) + " is truncated");
  }
  return message;
}

}  // namespace robotteamsim::ros_transport

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<robotteamsim::ros_transport::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const robotteamsim::ros_transport::RawMessage&) { return value(); }
};

template <>
struct DataType<robotteamsim::ros_transport::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const robotteamsim::ros_transport::RawMessage&) { return value(); }
};

template <>
struct Definition<robotteamsim::ros_transport::RawMessage> {
  static const char* value() { return ""; }
  static const char* value(const robotteamsim::ros_transport::RawMessage&) { return value(); }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<robotteamsim::ros_transport::RawMessage> {
  using RawMessage = robotteamsim::ros_transport::RawMessage;

  template <class Stream>
  static void write(Stream& stream, const RawMessage& message) {
    const auto size = static_cast<std::uint32_t>(message.bytes.size());
    std::memcpy(stream.advance(size), message.bytes.data(), size);
  }
  template <class Stream>
  static void read(Stream& stream, RawMessage& message) {
    message.bytes.assign(reinterpret_cast<const char*>(stream.getData()), stream.getLength());
  }
  static std::uint32_t serializedLength(const RawMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};

}  // namespace serialization
}  // namespace ros
