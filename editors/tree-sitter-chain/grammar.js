// The language of flank for editors without its server: highlighting, folding. It takes whatever the program's own parser takes, and
// some texts more; a test holds it against that parser. `cargo run` in generate/ makes src/parser.c.

const list = (rule) => seq(rule, repeat(seq(',', rule)));
const listed = (rule) => optional(seq(list(rule), optional(',')));

// words that mean something only where nothing else can stand, and are names elsewhere
const FREE = [
  'profile', 'cut', 'nc', 'error', 'insert', 'close', 'unknown', 'solid', 'contact', 'want', 'mill', 'expect', 'step', 'as', 'keep',
  'along', 'about', 'towards', 'where', 'for', 'with', 'of', 'near', 'within', 'travel', 'nothing', 'passes', 'side', 'both', 'ways', 'clear',
  'scallop', 'chord', 'lead', 'tilt', 'stock', 'linear', 'rotary', 'inside', 'outside',
];
const names = (...without) => ($) => choice($.identifier, ...FREE.filter((word) => !without.includes(word)).map((word) => alias(word, $.identifier)));

const UNITS = ['mm', 'um', 'µm', 'μm', 'cm', 'inch', 'deg', 'rad', 'arcmin', 'arcsec', 'rev'];

module.exports = grammar({
  name: 'chain',
  word: ($) => $.identifier,
  extras: ($) => [/\s/, /\uFEFF/, $.comment],
  supertypes: ($) => [$.expression],
  conflicts: ($) => [
    [$._name, $.expected_error],
    [$._name, $.expected_travel],
    [$._name, $.expected_nothing],
    [$._unit],
    [$.unit],
    [$.insert],
    [$.frame],
  ],

  rules: {
    source_file: ($) => repeat(choice($.use, $.function, $.machine, $.tool, $.variant, $.job)),

    comment: () => token(seq('//', /[^\n\r]*/)),
    identifier: () => /[\p{XID_Start}_][\p{XID_Continue}]*/,
    _name: names(),
    _dimension_name: names('along'),
    _status_name: names('near'),
    string: () => token(seq('"', /[^"\n\r]*/, '"')),

    use: ($) => seq('use', $.string),
    function: ($) => seq(
      'fn', field('name', $._name), '(', listed($.formal), ')', optional(seq('->', $.type)),
      choice(seq('=', $.expression), seq('{', repeat($.let), $.expression, '}')),
    ),
    formal: ($) => seq(field('name', $._name), ':', $.type),
    type: ($) => seq($.dimension, optional(seq(choice('[', token.immediate('[')), $.integer, ']'))),

    machine: ($) => seq('machine', field('name', $._name), optional(seq('extends', field('parent', $._name))), $.machine_body),
    machine_body: ($) => seq('{', repeat(choice(
      $.param, $.error_term, $.let, $.axis, $.unknown_axis, $.frame, $.insert, $.close, $.fix, $.couple, $.nc_word, $.requirement,
      $.machine_expectation,
    )), '}'),
    tool: ($) => seq('tool', field('name', $._name), $.tool_body),
    tool_body: ($) => seq('{', repeat(choice($.param, $.let, $.profile, $.tool_surface, $.requirement)), '}'),
    job: ($) => seq('job', field('name', $._name), optional(seq('extends', $.variant_of)), $.job_body),
    variant: ($) => seq('job', field('name', $._name), '=', $.variant_of),
    variant_of: ($) => seq(field('parent', $._name), optional(seq(token.immediate('('), listed($.change), ')'))),
    change: ($) => seq($.path, ':', $.expression),
    job_body: ($) => seq('{', repeat(choice(
      $.param, $.let, $.machine_instance, $.tool_instance, $.mount, $.motion, $.unknown, $.drive, $.surface, $.trim, $.cut, $.profile,
      $.solid, $.contact, $.want, $.mill, $.sample, $.requirement, $.expectation,
    )), '}'),

    param: ($) => seq(
      'param', field('name', $._name), ':', $.dimension, optional(seq('in', $.range)), optional(seq('step', $.expression)),
      optional(seq('=', $.expression)),
    ),
    error_term: ($) => seq('error', field('name', $._name), ':', $.dimension, optional(seq('in', $.range))),
    let: ($) => seq('let', field('name', $._name), '=', $.expression),
    requirement: ($) => seq('require', $.expression, ',', $.string),

    axis: ($) => seq('axis', field('name', $._name), ':', $.axis_kind, optional(seq('in', $.range))),
    unknown_axis: ($) => seq('unknown', field('name', $._name), ':', $.axis_kind, 'in', $.range),
    axis_kind: () => choice('linear', 'rotary'),
    frame: ($) => seq('frame', field('name', $._name), optional(seq('in', field('parent', $._name), '=', repeat1($.transform)))),
    insert: ($) => seq('insert', field('name', $._name), 'in', field('parent', $._name), '=', repeat1($.transform)),
    transform: ($) => seq(field('function', $._name), $.arguments),
    close: ($) => seq(
      'close', $._name, '=', $._name, optional(seq('along', list($._name))), optional(seq('about', list($._name))),
      repeat(seq('keep', $._name, ':', $.range)),
    ),
    fix: ($) => seq('fix', $._name, '=', $.expression),
    couple: ($) => seq('couple', $._name, '=', $.expression),
    nc_word: ($) => seq('nc', $._name, '=', $.expression, optional(seq('by', $.expression))),

    profile: ($) => seq('profile', field('name', $._name), '{', repeat($.segment), '}'),
    segment: ($) => seq(field('name', $._name), '=', $.expression),

    tool_surface: ($) => seq(
      'surface', list(field('name', $._name)), '(', listed($.surface_parameter), ')', optional($.each_side), '{',
      repeat(choice($.let, $.at, $.body)), '}',
    ),
    each_side: ($) => seq('for', field('name', $._name), 'in', $.vector),
    surface_parameter: ($) => seq(
      field('name', $._name), ':', choice(seq('along', $._name), seq(alias($._parameter_dimension, $.dimension), 'in', $.range)),
    ),
    at: ($) => seq('at', '=', $.expression),
    body: ($) => seq('body', choice('inside', 'outside', seq('towards', $.expression), seq('where', $.expression))),

    machine_instance: ($) => seq('machine', field('name', $._name), '=', $.definition),
    tool_instance: ($) => seq('tool', field('name', $._name), '=', $.definition),
    definition: ($) => seq(field('definition', $._name), optional($.settings)),
    settings: ($) => seq(token.immediate('('), listed($.setting), ')'),
    setting: ($) => seq(field('name', $._name), ':', $.expression),
    mount: ($) => seq('mount', list($._name), 'on', $.path),
    parameter: ($) => seq(field('name', $._name), ':', $.dimension, 'in', $.range),
    motion: ($) => seq('motion', $.parameter),
    unknown: ($) => seq('unknown', $.parameter),
    drive: ($) => seq('drive', list($.path), '=', list($.expression)),
    surface: ($) => seq('surface', list(field('name', $._name)), 'in', $.path, '=', $.expression),
    trim: ($) => seq('trim', $.path, 'by', $.path),
    cut: ($) => seq('cut', $.path, 'by', $.path),
    solid: ($) => seq('solid', field('name', $._name), 'in', $.path, '=', $.expression),
    contact: ($) => seq('contact', field('name', $._name), '=', $.path, 'with', $.path, repeat(seq(',', $.setting))),
    want: ($) => seq('want', field('name', $._name), 'in', $.path, '=', $.expression),
    mill: ($) => seq(
      'mill', field('name', $._name), 'of', $.path, 'with', $.path, 'in', $.path, '{',
      repeat(choice($.passes, $.attitude, $.both_ways, $.clearance)), '}',
    ),
    passes: ($) => seq(choice('passes', 'side', 'along'), $._name, optional($.coordinate), ':', $.range, optional(','), choice('scallop', 'step', 'chord', 'by'), $.expression),
    attitude: ($) => seq(choice('lead', 'tilt', 'stock'), $.expression),
    both_ways: () => seq('both', 'ways'),
    clearance: ($) => seq('clear', 'of', $.path, 'by', $.expression, 'with', $.path),
    sample: ($) => seq(
      'sample', list($.sampled), optional($.each_side), '{',
      optional(seq($._asked, repeat(seq(optional(','), $._asked)), optional(','))), '}',
    ),
    sampled: ($) => seq($.path, optional(seq('as', field('name', $._name)))),
    _asked: ($) => choice($.keep, $.limit, $.entry),
    keep: ($) => seq('keep', $._name, optional($.coordinate), ':', $.range),
    limit: ($) => seq('require', $._name, optional($.coordinate), ':', $.range, ',', $.string),
    entry: ($) => seq($._name, optional($.coordinate), ':', $.expression, optional(seq('..', $.expression, 'by', $.expression))),
    coordinate: ($) => seq('=', $.expression),

    expectation: ($) => seq('expect', choice($.expected_error, $.expected_nothing, $.expected_on, $.expected_travel, $.expected_status, $.expected_value)),
    machine_expectation: ($) => seq('expect', choice($.expected_on, $.expected_travel, $.expected_pose)),
    expected_error: ($) => prec.dynamic(1, seq('error', $.identifier)),
    expected_nothing: () => prec.dynamic(1, 'nothing'),
    expected_travel: () => prec.dynamic(1, 'travel'),
    expected_on: ($) => seq('on', $.definition, 'within', $.expression),
    expected_status: ($) => seq($.path, alias($._status_name, $.status), optional(seq('at', $.expression))),
    expected_value: ($) => seq(
      optional(seq($.path, ':')), $.expression, choice(seq('near', $.expression, 'within', $.expression), seq('in', $.range)),
    ),
    expected_pose: ($) => seq(
      $._name, 'in', $._name, 'near', repeat1($.transform), 'at', alias($._at, $.settings), 'within', $.expression,
      optional(seq(',', $.expression)),
    ),
    _at: ($) => seq('(', listed($.setting), ')'),

    range: ($) => seq($.expression, '..', $.expression),
    dimension: ($) => seq($._factor, repeat(seq(choice('*', '/'), $._factor))),
    _factor: ($) => choice('1', seq(choice($.dimension_word, $._name), optional(seq('^', $.integer)))),
    _parameter_dimension: ($) => seq($._parameter_factor, repeat(seq(choice('*', '/'), $._factor))),
    _parameter_factor: ($) => choice('1', seq(choice($.dimension_word, $._dimension_name), optional(seq('^', $.integer)))),
    dimension_word: () => choice('length', 'angle', 'number', 'count'),
    integer: () => /-?[0-9]+/,

    expression: ($) => choice(
      $.conditional, $.binary, $.unary, $.index, $.number, $.string, $.group, $.vector, $.call, $.path,
    ),
    conditional: ($) => prec.right(seq('if', $.expression, 'then', $.expression, 'else', $.expression)),
    unary: ($) => prec(6, seq(choice('-', 'not'), $.expression)),
    binary: ($) => choice(
      prec.left(1, seq($.expression, 'or', $.expression)),
      prec.left(2, seq($.expression, 'and', $.expression)),
      prec.left(3, seq($.expression, choice('<', '<=', '>', '>=', '==', '!='), $.expression)),
      prec.left(4, seq($.expression, choice('+', '-'), $.expression)),
      prec.left(5, seq($.expression, choice('*', '/'), $.expression)),
      prec.right(7, seq($.expression, '^', $.expression)),
    ),
    index: ($) => prec(8, seq($.expression, token.immediate('['), $.expression, ']')),
    group: ($) => seq('(', $.expression, ')'),
    vector: ($) => seq('[', listed($.expression), ']'),
    call: ($) => seq(field('function', $._name), $.arguments),
    arguments: ($) => seq(token.immediate('('), listed(choice($.argument, $.bound, $.expression)), ')'),
    argument: ($) => seq(field('name', $._name), ':', choice($.dimension_word, $.expression)),
    bound: ($) => seq(field('name', $._name), 'in', $.range, ':', $.expression),
    path: ($) => prec.right(seq($._name, repeat(seq('.', $._name)))),
    number: ($) => seq($._literal, optional($.unit)),
    _literal: () => /[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?/,
    unit: ($) => seq($._unit, repeat(seq('/', $._unit))),
    _unit: ($) => seq(choice(...UNITS), optional(seq('^', optional('-'), $._literal))),
  },
});
