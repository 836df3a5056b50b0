// From a row of the table of keys to a member of a scene, and back. A codec turns a value of the table into
// one of the scene with set(to, from), and back with get(from).
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

/// Names of the words, for `choices` of a row.
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
    static void set(T& to, const KeyValue& from) {
        if constexpr (std::is_integral_v<T>)
            to = static_cast<T>(std::get<std::int64_t>(from));
        else
            to = std::get<T>(from);
    }
    template <class T>
    static OptionalValue get(const T& from) {
        if constexpr (std::is_integral_v<T>)
            return static_cast<std::int64_t>(from);
        else if constexpr (std::is_floating_point_v<T>)
            return from;
        else
            return from.empty() ? std::nullopt : OptionalValue(from);
    }
};

/// Numbers of which 0 means absent.
struct UnlessZero : AsIs {
    template <class T>
    static OptionalValue get(const T& from) {
        return from > T{} ? AsIs::get(from) : std::nullopt;
    }
};

/// A value that one of `words` stands for.
template <const auto& words>
struct OneOf {
    template <class T>
    static void set(T& to, const KeyValue& from) {
        to = std::ranges::find(words, std::get<std::string>(from), &Word<T>::name)->value;
    }
    template <class T>
    static OptionalValue get(const T& from) {
        return std::string(std::ranges::find(words, from, &Word<T>::value)->name);
    }
};

/// A row of a model table, by its name.
template <auto find>
struct RowOf {
    template <class T>
    static void set(T& to, const KeyValue& from) {
        to = find(std::get<std::string>(from));
    }
    template <class T>
    static OptionalValue get(const T& from) {
        return from ? OptionalValue(std::string(from->name)) : std::nullopt;
    }
};

/// The part itself; an optional one is made where it is empty.
template <class T>
T& ensured(T& part) {
    return part;
}
template <class T>
T& ensured(std::optional<T>& part) {
    return part ? *part : part.emplace();
}
/// Null where an optional part is empty.
template <class T>
const T* pointer_to(const T& part) {
    return &part;
}
template <class T>
const T* pointer_to(const std::optional<T>& part) {
    return part ? &*part : nullptr;
}

/// A codec for a member, or a member of a member and so on. Reading makes the optional ones on the way.
template <class Codec, auto... members>
struct Chain : Codec {};

template <class Codec, auto member, auto... rest>
struct Chain<Codec, member, rest...> {
    template <class T>
    static void set(T& object, const KeyValue& from) {
        Chain<Codec, rest...>::set(ensured(object.*member), from);
    }
    template <class T>
    static OptionalValue get(const T& object) {
        const auto* part = pointer_to(object.*member);
        return part ? Chain<Codec, rest...>::get(*part) : std::nullopt;
    }
};

/// Binding of an object by a codec of its own.
template <class Codec, class Object>
constexpr BindingOf<Object> bound{[](Object& object, const KeyValue& value) { Codec::set(object, value); },
                                  [](const Object& object) { return Codec::get(object); }};

template <class Object, class Member>
Object owner_of(Member Object::*member);

template <class Codec, auto first, auto... rest>
constexpr auto chain = bound<Chain<Codec, first, rest...>, decltype(owner_of(first))>;

// Bindings of rows: the members lead from Scene, Parachute, ... to the value.
template <auto... members>
constexpr auto member = chain<AsIs, members...>;
template <auto... members>
constexpr auto unless_zero = chain<UnlessZero, members...>;
template <const auto& words, auto... members>
constexpr auto word_of = chain<OneOf<words>, members...>;
template <auto find, auto... members>
constexpr auto row_of = chain<RowOf<find>, members...>;

}  // namespace twinchute
