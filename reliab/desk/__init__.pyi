from .server import serve_desk as serve_desk
