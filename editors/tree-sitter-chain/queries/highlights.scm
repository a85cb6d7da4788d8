(comment) @comment
(string) @string
(number) @number
(unit) @type.builtin
(dimension_word) @type.builtin
(axis_kind) @type.builtin
(status) @constant

["use" "fn" "machine" "extends" "tool" "job" "param" "let" "axis" "frame" "fix" "couple" "surface" "at" "body" "mount" "on" "motion"
 "drive" "trim" "sample" "in" "by" "require" "profile" "cut" "nc" "error" "insert" "close" "unknown" "solid" "contact" "want" "mill"
 "expect" "step" "as" "keep" "along" "about" "towards" "where" "for" "with" "of" "near" "within" "passes" "side" "both" "ways" "clear"
 "scallop" "chord" "lead" "tilt" "stock" "inside" "outside"] @keyword
["if" "then" "else"] @keyword.conditional
["and" "or" "not"] @keyword.operator
["+" "-" "*" "/" "^" "<" "<=" ">" ">=" "==" "!=" "=" ".." "->"] @operator
["{" "}" "(" ")" "[" "]"] @punctuation.bracket
["," ":" "."] @punctuation.delimiter

(machine name: (identifier) @type)
(machine parent: (identifier) @type)
(tool name: (identifier) @type)
(job name: (identifier) @type)
(variant name: (identifier) @type)
(variant_of parent: (identifier) @type)
(definition definition: (identifier) @type)
(function name: (identifier) @function)
(call function: (identifier) @function)
(transform function: (identifier) @function)
(param name: (identifier) @variable)
(error_term name: (identifier) @variable)
(let name: (identifier) @variable)
(axis name: (identifier) @variable)
(unknown_axis name: (identifier) @variable)
(frame name: (identifier) @module)
(formal name: (identifier) @variable.parameter)
(parameter name: (identifier) @variable)
(argument name: (identifier) @property)
(setting name: (identifier) @property)
