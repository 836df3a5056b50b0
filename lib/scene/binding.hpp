// From a row of the table of keys to a member of a scene, and back.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "lib/scene/keys.hpp"

namespace twinchute {

/// A word of a scene and what it stands for.
template <class T>
struct Word {
    std::string_view name;
    T value;
};

/// What `choices` of a row asks for.
template <const auto& words>
std::vector<std::string_view> words_in() {
    std::vector<std::string_view> names;
    for (const auto& word : words)
        names.push_back(word.name);
    return names;
}

/// Numbers as they are; an empty text or list is absent.
struct AsIs {
    template <class T>
    static void take(T& to, const KeyValue& from) {
        if constexpr (std::is_integral_v<T>)
            to = static_cast<T>(std::get<std::int64_t>(from));
        else
            to = std::get<T>(from);
    }
    template <class T>
    static std::optional<KeyValue> tell(const T& from) {
        if constexpr (std::is_integral_v<T>)
            return static_cast<std::int64_t>(from);
        else if constexpr (std::is_floating_point_v<T>)
            return from;
        else
            return from.empty() ? std::nullopt : std::optional<KeyValue>(from);
    }
};

/// Numbers of which 0 means absent.
struct UnlessZero : AsIs {
    template <class T>
    static std::optional<KeyValue> tell(const T& from) {
        return from > T{} ? AsIs::tell(from) : std::nullopt;
    }
};

/// A value that one of `words` stands for.
template <const auto& words>
struct OneOf {
    template <class T>
    static void take(T& to, const KeyValue& from) {
        to = std::ranges::find(words, std::get<std::string>(from), &Word<T>::name)->value;
    }
    template <class T>
    static std::optional<KeyValue> tell(const T& from) {
        return std::string(std::ranges::find(words, from, &Word<T>::value)->name);
    }
};

/// A row of a model table, by its name.
template <auto find>
struct RowOf {
    template <class T>
    static void take(T& to, const KeyValue& from) {
        to = find(std::get<std::string>(from));
    }
    template <class T>
    static std::optional<KeyValue> tell(const T& from) {
        return from ? std::optional<KeyValue>(std::string(from->name)) : std::nullopt;
    }
};

template <class T>
T& made(T& part) {
    return part;
}
template <class T>
T& made(std::optional<T>& part) {
    return part ? *part : part.emplace();
}
template <class T>
const T* found(const T& part) {
    return &part;
}
template <class T>
const T* found(const std::optional<T>& part) {
    return part ? &*part : nullptr;
}

/// A member, or a member of a member and so on. Optional ones are made when a value goes in; nothing comes
/// out of an empty one.
template <class Codec, auto... members>
struct Along : Codec {};

template <class Codec, auto member, auto... rest>
struct Along<Codec, member, rest...> {
    template <class T>
    static void take(T& object, const KeyValue& from) {
        Along<Codec, rest...>::take(made(object.*member), from);
    }
    template <class T>
    static std::optional<KeyValue> tell(const T& object) {
        const auto* part = found(object.*member);
        return part ? Along<Codec, rest...>::tell(*part) : std::nullopt;
    }
};

template <class Codec, class Object>
constexpr BindingOf<Object> bound{[](Object& object, const KeyValue& value) { Codec::take(object, value); },
                                  [](const Object& object) { return Codec::tell(object); }};

template <class Object, class Member>
Object owner_of(Member Object::*member);

template <class Codec, auto first, auto... rest>
constexpr auto along = bound<Along<Codec, first, rest...>, decltype(owner_of(first))>;

// Bindings of rows: the members lead from Scene, Parachute, ... to the value.
template <auto... members>
constexpr auto member = along<AsIs, members...>;
template <auto... members>
constexpr auto unless_zero = along<UnlessZero, members...>;
template <const auto& words, auto... members>
constexpr auto word_of = along<OneOf<words>, members...>;
template <auto find, auto... members>
constexpr auto row_of = along<RowOf<find>, members...>;

}  // namespace twinchute
