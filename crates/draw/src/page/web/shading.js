// How surfaces look: colours of a scale, light from the eye's upper left, what is not yet cut pale, the line of contact.

/** The contact line reaches so many pixels to each side, its white edge so many. */
const LINE_WIDTH = 1.6;
const EDGE_WIDTH = 3.2;

const VERTEX = `
attribute float quantity;
attribute float known;
attribute vec4 motion;
varying float vQuantity;
varying float vKnown;
varying vec4 vMotion;
varying vec3 vNormal;
varying vec3 vToEye;
void main() {
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    vQuantity = quantity;
    vKnown = known;
    vMotion = motion;
    vNormal = normalMatrix * normal;
    vToEye = -seen.xyz;
    gl_Position = projectionMatrix * seen;
}`;

const FRAGMENT = `
uniform vec3 plain;
uniform vec3 scale[5];
uniform vec2 range;
uniform bool isColoured;
uniform bool isCut;
uniform vec4 now;
uniform vec4 used;
uniform vec3 lineColour;
uniform float opacity;
varying float vQuantity;
varying float vKnown;
varying vec4 vMotion;
varying vec3 vNormal;
varying vec3 vToEye;

vec3 ofScale(float share) {
    float along = clamp(share, 0.0, 1.0) * 4.0;
    vec3 colour = scale[0];
    for (int k = 0; k < 4; ++k) colour = mix(colour, scale[k + 1], clamp(along - float(k), 0.0, 1.0));
    return colour;
}

float on(vec4 away, float width) {
    vec4 near = (1.0 - smoothstep(width - 0.7, width + 0.7, away)) * used;
    return max(max(near.x, near.y), max(near.z, near.w));
}

void main() {
    vec3 base = plain;
    if (isColoured) {
        float width = range.y - range.x;
        base = vKnown < 0.999 ? vec3(0.75) : ofScale(width > 0.0 ? (vQuantity - range.x) / width : 0.5);
    }
    vec3 normal = normalize(vNormal);
    float facing = dot(normal, normalize(vToEye));
    if (facing < 0.0) normal = -normal;
    float light = max(dot(normal, normalize(vec3(-0.45, 0.6, 0.66))), 0.0);
    vec3 colour = base * (0.62 + 0.38 * light) + 0.06 * pow(light, 12.0);
    float alpha = opacity;
    if (isCut && any(greaterThan(used * (vMotion - now), vec4(0.0)))) {
        colour = mix(colour, vec3(0.9), 0.8);
        alpha *= 0.6;
    }
    vec4 away = abs(vMotion - now) / max(fwidth(vMotion), vec4(1e-12));
    float onEdge = on(away, EDGE_WIDTH);
    colour = mix(mix(colour, vec3(1.0), 0.85 * onEdge), lineColour, on(away, LINE_WIDTH));
    gl_FragColor = vec4(colour, mix(alpha, 1.0, onEdge));
}`;

/** Of a work's surface; `uniforms` are shared by all of them but for `plain` and `used`. */
export function workMaterial(shared, plain, used) {
    return new THREE.ShaderMaterial({
        vertexShader: VERTEX,
        fragmentShader: FRAGMENT.replaceAll("LINE_WIDTH", LINE_WIDTH.toFixed(1)).replaceAll("EDGE_WIDTH", EDGE_WIDTH.toFixed(1)),
        uniforms: { ...shared, plain: { value: plain }, used: { value: used }, opacity: { value: 1 } },
        side: THREE.DoubleSide,
        transparent: true,
    });
}

const TOOL_FRAGMENT = `
uniform vec3 plain;
uniform float opacity;
varying vec3 vNormal;
varying vec3 vToEye;
void main() {
    vec3 normal = normalize(vNormal);
    float facing = abs(dot(normal, normalize(vToEye)));
    // steep to the eye it is denser, as glass is: so its outline shows
    gl_FragColor = vec4(plain * (0.6 + 0.4 * facing), min(opacity * mix(2.2, 0.8, facing), 1.0));
}`;

/** Of a tool, which is seen through. */
export function toolMaterial(plain, opacity) {
    return new THREE.ShaderMaterial({
        vertexShader: VERTEX,
        fragmentShader: TOOL_FRAGMENT,
        uniforms: { plain: { value: plain }, opacity },
        side: THREE.DoubleSide,
        transparent: true,
        depthWrite: false,
    });
}

const BODY_VERTEX = `
attribute vec3 tint;
varying vec3 vTint;
varying vec3 vNormal;
varying vec3 vToEye;
void main() {
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    vTint = tint;
    vNormal = normalMatrix * normal;
    vToEye = -seen.xyz;
    gl_Position = projectionMatrix * seen;
}`;

const BODY_FRAGMENT = `
varying vec3 vTint;
varying vec3 vNormal;
varying vec3 vToEye;
void main() {
    vec3 normal = normalize(vNormal);
    if (dot(normal, normalize(vToEye)) < 0.0) normal = -normal;
    float light = max(dot(normal, normalize(vec3(-0.45, 0.6, 0.66))), 0.0);
    gl_FragColor = vec4(vTint * (0.6 + 0.4 * light) + 0.08 * pow(light, 14.0), 1.0);
}`;

/** Of whole gears; behind the surfaces that lie on them. */
export function bodyMaterial() {
    return new THREE.ShaderMaterial({
        vertexShader: BODY_VERTEX,
        fragmentShader: BODY_FRAGMENT,
        side: THREE.DoubleSide,
        polygonOffset: true,
        polygonOffsetFactor: 2,
        polygonOffsetUnits: 2,
    });
}
