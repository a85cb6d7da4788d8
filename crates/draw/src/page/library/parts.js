// What the page uses of three.js; all else is left out of the bundle.
export {
    BufferAttribute, BufferGeometry, CylinderGeometry, DoubleSide, Group, Line, LineBasicMaterial, LineSegments, Matrix4, Mesh,
    MeshBasicMaterial, PerspectiveCamera, Raycaster, Scene, ShaderMaterial, Sphere, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
