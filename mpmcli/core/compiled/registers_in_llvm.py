"""What ``core.compiled.registers`` is in compiled code: a type, and the code of each function."""

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, make_intrinsic_template, signature
from numba.extending import models, register_model

from mpmcli.core.compiled import registers

DOUBLE = ir.DoubleType()
INDEX = ir.IntType(32)


def written_in_llvm(name: Callable[..., Any]) -> Callable[[Callable[..., Any]], None]:
    """Decorate what gives, for the types of arguments, signature and code of the function ``name``."""

    def decorate(definition: Callable[..., Any]) -> None:
        infer_global(name, types.Function(make_intrinsic_template(name, definition, name.__name__)))

    return decorate


class Register(types.Type):
    """``count`` float64 in one register."""

    def __init__(self, count: int):
        self.count = count
        super().__init__(name=f"Register({count})")


@register_model(Register)
class RegisterModel(models.PrimitiveModel):
    """A vector type of LLVM; the compiler splits what the machine has no register for."""

    def __init__(self, manager: Any, register: Register):
        super().__init__(manager, register, ir.VectorType(DOUBLE, register.count))


def _address(context: Any, builder: Any, array_type: Any, array: Any, i: Any, count: int) -> Any:
    data = cgutils.create_struct_proxy(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [i]), ir.VectorType(DOUBLE, count).as_pointer())


def _load(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    count = sig.return_type.count
    return builder.load(_address(context, builder, sig.args[0], args[0], args[1], count), align=8)


def _all_alike(builder: Any, number: Any, count: int) -> Any:
    empty = ir.Constant(ir.VectorType(DOUBLE, count), ir.Undefined)
    one = builder.insert_element(empty, number, INDEX(0))
    return builder.shuffle_vector(one, empty, ir.Constant(ir.VectorType(INDEX, count), [0] * count))


def _intrinsic(name: str, arguments: int) -> Callable[..., Any]:
    """Code of an instruction of LLVM that acts on numbers and on registers alike."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        kind = args[0].type
        suffix = f"v{kind.count}f64" if isinstance(kind, ir.VectorType) else "f64"
        function = ir.FunctionType(kind, [kind] * arguments)
        return builder.call(
            cgutils.get_or_insert_function(builder.module, function, f"llvm.{name}.{suffix}"), args
        )

    return build


@written_in_llvm(registers.load)
def _(typing_context: Any, array: Any, i: Any, like: Any) -> Any:
    return Register(len(like))(array, types.uint64, like), _load


@written_in_llvm(registers.read)
def _(typing_context: Any, array: Any, i: Any, like: Any) -> Any:
    count = len(like)
    if count != 3:
        return Register(count)(array, types.uint64, like), _load

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        four, mask = ir.VectorType(DOUBLE, 4), ir.VectorType(ir.IntType(1), 4)
        address = _address(context, builder, sig.args[0], args[0], args[1], 4)
        masked_load = cgutils.get_or_insert_function(
            builder.module,
            ir.FunctionType(four, [four.as_pointer(), INDEX, mask, four]),
            "llvm.masked.load.v4f64.p0v4f64",
        )
        wanted, zero = ir.Constant(mask, [1, 1, 1, 0]), ir.Constant(four, [0.0] * 4)
        whole = builder.call(masked_load, [address, INDEX(8), wanted, zero])
        return builder.shuffle_vector(whole, whole, ir.Constant(ir.VectorType(INDEX, 3), [0, 1, 2]))

    return Register(count)(array, types.uint64, like), build


@written_in_llvm(registers.store)
def _(typing_context: Any, array: Any, i: Any, value: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        address = _address(context, builder, sig.args[0], args[0], args[1], value.count)
        builder.store(args[2], address, align=8)
        return context.get_dummy_value()

    return types.void(array, types.uint64, value), build


@written_in_llvm(registers.pack)
def _(typing_context: Any, components: Any) -> Any:
    count = len(components)

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        vector = ir.Constant(ir.VectorType(DOUBLE, count), ir.Undefined)
        for position, value in enumerate(cgutils.unpack_tuple(builder, args[0])):
            vector = builder.insert_element(vector, value, INDEX(position))
        return vector

    return Register(count)(types.UniTuple(types.float64, count)), build


@written_in_llvm(registers.zeros)
def _(typing_context: Any, like: Any) -> Any:
    count = len(like)

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return ir.Constant(ir.VectorType(DOUBLE, count), [0.0] * count)

    return Register(count)(like), build


@written_in_llvm(registers.offsets)
def _(typing_context: Any, start: Any, like: Any) -> Any:
    count = len(like)

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        counted = ir.Constant(ir.VectorType(DOUBLE, count), [float(i) for i in range(count)])
        return builder.fsub(_all_alike(builder, args[0], count), counted)

    return Register(count)(types.float64, like), build


@written_in_llvm(registers.positive_part)
def _(typing_context: Any, value: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        zero = context.get_constant_null(value)
        return builder.select(builder.fcmp_ordered(">", args[0], zero), args[0], zero)

    return value(value), build


@written_in_llvm(registers.transposed)
def _(typing_context: Any, rows: Any) -> Any:
    column = types.UniTuple(types.float64, len(rows))

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        members = cgutils.unpack_tuple(builder, args[0])
        columns = [
            context.make_tuple(
                builder, column, [builder.extract_element(row, INDEX(position)) for row in members]
            )
            for position in range(rows[0].count)
        ]
        return context.make_tuple(builder, sig.return_type, columns)

    return types.UniTuple(column, rows[0].count)(rows), build


@written_in_llvm(registers.each)
def _(typing_context: Any, value: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        parts = [builder.extract_element(args[0], INDEX(position)) for position in range(value.count)]
        return context.make_tuple(builder, sig.return_type, parts)

    return types.UniTuple(types.float64, value.count)(value), build


@written_in_llvm(registers.total)
def _(typing_context: Any, value: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        found = builder.extract_element(args[0], INDEX(0))
        for position in range(1, value.count):
            found = builder.fadd(found, builder.extract_element(args[0], INDEX(position)))
        return found

    return types.float64(value), build


@written_in_llvm(registers.plus)
def _(typing_context: Any, total: Any, weight: Any, value: Any) -> Any:
    is_register = isinstance(weight, Register)

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        total, weights, value = args
        if not is_register:
            weights = _all_alike(builder, weights, sig.return_type.count)
        return _intrinsic("fma", 3)(context, builder, sig, [weights, value, total])

    return total(total, weight if is_register else types.float64, value), build


class _Arithmetic(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        registers = {kind for kind in args if isinstance(kind, Register)}
        if len(registers) != 1 or not all(isinstance(kind, Register | types.Number) for kind in args):
            return None
        register = registers.pop()
        return signature(register, *(kind if kind == register else types.float64 for kind in args))


def _arithmetic(instruction: str) -> Callable[..., Any]:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        count = sig.return_type.count
        vectors = (
            value if isinstance(kind, Register) else _all_alike(builder, value, count)
            for kind, value in zip(sig.args, args, strict=True)
        )
        return getattr(builder, instruction)(*vectors)

    return build


for _operator, _instruction in (
    (operator.add, "fadd"),
    (operator.iadd, "fadd"),
    (operator.sub, "fsub"),
    (operator.isub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    infer_global(_operator)(type("_Arithmetic", (_Arithmetic,), {"key": _operator}))
    for _kinds in ((Register, Register), (types.Float, Register), (Register, types.Float)):
        lower_builtin(_operator, *_kinds)(_arithmetic(_instruction))


class _Size(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        return signature(args[0], args[0]) if isinstance(args[0], Register) else None


infer_global(abs)(type("_Size", (_Size,), {"key": abs}))


lower_builtin(abs, Register)(_intrinsic("fabs", 1))


@written_in_llvm(registers.floor)
def _(typing_context: Any, value: Any) -> Any:
    return value(value), _intrinsic("floor", 1)


@written_in_llvm(registers.with_sign)
def _(typing_context: Any, value: Any, sign: Any) -> Any:
    return value(value, value), _intrinsic("copysign", 2)


@written_in_llvm(registers.stay_scalar)
def _(typing_context: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.function.attributes.add("noimplicitfloat")  # which is all that its vectorisers ask for
        return context.get_dummy_value()

    return types.void(), build
